#include "problems/contact/problem.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "problems/contact/load/plate_channels.h"
#include "problems/contact/load/posed_load.h"
#include "problems/contact/load/sheared_load.h"

namespace sinew {
namespace {

constexpr std::size_t kChannels = ContactProblem::kChannels;

// Parameters of a group that each channel depends on: normal forces depend on stiffness and dissipation only.
constexpr std::array<Eigen::Index, kChannels> kColumnsPerGroup{5, 2, 5, 2, 2, 5};

WrenchParts PartsFor(const std::array<bool, kChannels>& wanted) {
  if (wanted[kCopX] || wanted[kCopZ] || wanted[kFreeMoment]) return WrenchParts::kAll;
  return wanted[kFx] || wanted[kFz] ? WrenchParts::kForce : WrenchParts::kVertical;
}

// The parameters of the groups, then those of the effects.
ParameterList List(const ContactSettings& settings, const ContactEffectList& effects,
                   const std::vector<Stance>& stances) {
  struct Kind {
    const char* name;
    const char* unit;
    const char* meaning;
    Scale scale;
    const char* source;
  };
  constexpr std::array<Kind, kContactParametersPerGroup> kKinds{{
      {"stiffness", "N/m3", "pressure per depth of the sole's bed of springs", Scale::kLog, "thesis eq 5.1"},
      {"dissipation", "s/m", "growth of the pressure with the depth rate", Scale::kLinear, "thesis eq 5.1"},
      {"static_friction", "1", "friction at the transition velocity", Scale::kLinear,
       "Hollars; thesis eq 5.2"},
      {"dynamic_friction", "1", "friction at fast slip", Scale::kLinear, "Hollars; thesis eq 5.2"},
      {"viscous_friction", "s/m", "growth of the friction with slip speed", Scale::kLinear,
       "Hollars; thesis eq 5.2"},
  }};
  ParameterList list;
  ParameterListBuilder add(list);
  const auto groups = settings.Groups();
  for (const std::string& group : groups) {
    for (const Kind& kind : kKinds) {
      const ParameterRange& range = settings.parameters.at(kind.name);
      Parameter p;
      p.name = groups.size() == 1 ? kind.name : group + "." + kind.name;
      p.unit = kind.unit;
      p.meaning = kind.meaning;
      p.lower = range.lower;
      p.upper = range.upper;
      p.start = range.start;
      p.scale = kind.scale == Scale::kLog && range.lower > 0 ? Scale::kLog : Scale::kLinear;
      p.source = kind.source;
      add.Add(std::move(p));
    }
  }
  for (const int place : settings.SolePlaces()) {
    const std::string name = kSolePlaceNames[static_cast<std::size_t>(place)];
    const ParameterRange& range = settings.parameters.at(name);
    for (const std::string& group : groups) {
      Parameter p = BaseParameter(groups.size() == 1 ? name : group + "." + name, "m",
                                  "place of the sole on the foot, from where its regions draw it",
                                  range.lower, range.upper, range.start);
      add.Add(std::move(p));
    }
  }
  effects.Declare(add);
  if (settings.motion_errors) {
    const auto fitted = std::count_if(stances.begin(), stances.end(),
                                      [](const Stance& stance) { return stance.fitted && stance.measured; });
    for (Parameter& p : DeclareSpectrum(*settings.motion_errors, static_cast<int>(fitted)))
      add.Add(std::move(p));
  }
  if (!stances.empty()) {
    const StanceMotionErrors& errors = stances.front().motion_errors;
    for (int i = 0; i < errors.own; ++i) {
      const PoseTerm& term = errors.terms[static_cast<std::size_t>(i)];
      if (term.of == DeviationOf::kFloor) {
        add.Add(DeclareFloorVelocity(term.component,
                                     settings.FloorVelocityError()[term.component == kShiftX ? 0 : 1]));
        continue;
      }
      for (Parameter& p : DeclareWeights(term.component, term.weights, "", "")) add.Add(std::move(p));
    }
  }
  for (const Stance& stance : stances) {
    // A trial that has one plate is name enough.
    const bool alone = std::count_if(stances.begin(), stances.end(),
                                     [&](const Stance& other) { return other.trial == stance.trial; }) == 1;
    const std::string name = alone ? stance.trial : stance.trial + "/" + stance.plate;
    const StanceMotionErrors& errors = stance.motion_errors;
    for (std::size_t i = static_cast<std::size_t>(errors.own); i < errors.terms.size(); ++i) {
      const PoseTerm& term = errors.terms[i];
      for (Parameter& p : DeclareWeights(term.component, term.weights, stance.trial, name))
        add.Add(std::move(p));
    }
  }
  return list;
}

}  // namespace

std::vector<Parameter> DefaultContactParameters() {
  ContactSettings settings;
  settings.parameters = DefaultContactRanges();
  settings.regions.emplace_back();
  return List(settings, ContactEffectList(kContactParametersPerGroup, {}), {}).parameters;
}

// Scratch of one thread and one stance.
struct ContactProblem::Scratch {
  std::vector<ContactSums::Workspace> sums;  // per part
  std::vector<ContactLoadJacobian> by_part;  // of the fast path
  std::vector<ElasticFoundation> beds;       // per part
  EffectLoad with_effects;
  std::optional<PosedFoot> posed;  // where springs move
  DeviationBases curves;
  std::vector<Vec3> places;  // of the soles, per part
  ContactPoseJacobian by_pose;
  std::vector<ContactPlaceJacobian> by_place;  // per part
  ContactEffectValues effects{};
  bool at_null = true;
  bool differentiates_effects = false;
  std::array<bool, kContactEffects> wanted_effects{};  // a plate's own height counts as kHeightOffset
  bool differentiates_edges = false;
  SoleShear shear;
  bool shears = false;  // the sole gives way, or the derivative for that is wanted

  // Derivative of the load for a parameter. @param column of it in the block of the forward force
  // @param of_force that at a fixed velocity of the shear
  [[nodiscard]] ContactLoad Derivative(Eigen::Index column, const ContactLoad& of_force) {
    if (!shears || shear.compliance() == 0) return of_force;
    const Horizontal velocity = shear.Slope(column, {of_force[kForceX], of_force[kForceZ]});
    return of_force + with_effects.by_slip.jacobian * velocity;
  }
};

struct ContactProblem::ContactWorkspace final : Problem::Workspace {
  std::vector<Scratch> stances;
};

ContactProblem::ContactProblem(ContactSettings settings, ContactData data)
    : settings_(std::move(settings)),
      places_(settings_.SolePlaces()),
      data_(std::move(data)),
      list_(List(settings_, data_.effects, data_.stances)) {}

Result<std::unique_ptr<ContactProblem>> ContactProblem::Make(const Dataset& data, ContactSettings settings,
                                                             double margin) {
  SINEW_ASSIGN(auto prepared, PrepareContactData(data, settings, margin));
  std::unique_ptr<ContactProblem> problem(new ContactProblem(std::move(settings), std::move(prepared)));
  SINEW_TRY(CheckParameterList(problem->list_));
  SINEW_TRY(CheckLayout(problem->layout(), static_cast<int>(problem->parameters().size())));
  return problem;
}

std::unique_ptr<Problem::Workspace> ContactProblem::NewWorkspace() const {
  auto workspace = std::make_unique<ContactWorkspace>();
  for (const Stance& stance : data_.stances) {
    Scratch& scratch = workspace->stances.emplace_back();
    for (const Stance::Part& part : stance.parts) scratch.sums.push_back(part.sums.NewWorkspace());
    scratch.by_part.resize(stance.parts.size());
    scratch.beds.resize(stance.parts.size());
    scratch.with_effects.by_part.resize(stance.parts.size());
    scratch.places.assign(stance.parts.size(), Vec3::Zero());
    scratch.by_place.resize(stance.parts.size());
    const Block& forward = data_.layout[static_cast<std::size_t>(stance.blocks[kFx])];
    scratch.shear = SoleShear(static_cast<Eigen::Index>(forward.columns.size()));
    if (!settings_.moves_springs()) continue;
    scratch.posed.emplace(stance.kinematics);
    for (const FootMotion::Springs& springs : stance.foot.springs)
      scratch.with_effects.by_spring.emplace_back(springs.position.size());
  }
  return workspace;
}

ElasticFoundation ContactProblem::Foundation(const Vector& parameters, int group) {
  const Eigen::Index first = group * kContactParametersPerGroup;
  return {parameters[first], parameters[first + 1], parameters[first + 2], parameters[first + 3],
          parameters[first + 4]};
}

ContactEffectValues ContactProblem::EffectsOn(const std::string& plate, const Vector& parameters) const {
  ContactEffectValues values{};
  const int first = data_.effects.first();
  for (std::size_t i = 0; i < kContactEffects; ++i) values[i] = parameters[first + static_cast<int>(i)];
  const int own = data_.effects.OwnHeight(plate);
  if (own >= 0) values[kHeightOffset] += parameters[own];
  return values;
}

void ContactProblem::SolePlacesInto(const Stance& stance, const Vector& parameters,
                                    std::vector<Vec3>& places) const {
  for (std::size_t slot = 0; slot < places_.size(); ++slot) {
    for (std::size_t p = 0; p < stance.parts.size(); ++p)
      places[p][places_[slot]] = parameters[PlaceIndex(slot, stance.parts[p].group)];
  }
}

Status ContactProblem::Predict(const Query& query, Workspace& workspace, Prediction& prediction) const {
  auto& scratches = static_cast<ContactWorkspace&>(workspace).stances;
  for (std::size_t s = 0; s < data_.stances.size(); ++s) {
    const Stance& stance = data_.stances[s];
    std::array<bool, kChannels> wanted{};
    for (std::size_t c = 0; c < kChannels; ++c)
      wanted[c] = query.blocks[static_cast<std::size_t>(stance.blocks[c])];
    if (std::find(wanted.begin(), wanted.end(), true) == wanted.end()) continue;

    Scratch& scratch = scratches[s];
    for (std::size_t p = 0; p < stance.parts.size(); ++p)
      scratch.beds[p] = Foundation(query.parameters, stance.parts[p].group);
    scratch.effects = EffectsOn(stance.plate, query.parameters);
    scratch.at_null =
        std::all_of(scratch.effects.begin(), scratch.effects.end(), [](double value) { return value == 0; });
    const int first = data_.effects.first();
    const int own = data_.effects.OwnHeight(stance.plate);
    for (std::size_t i = 0; i < kContactEffects; ++i)
      scratch.wanted_effects[i] = query.Differentiates(first + static_cast<int>(i));
    scratch.wanted_effects[kHeightOffset] |= own >= 0 && query.Differentiates(own);
    scratch.differentiates_effects = std::find(scratch.wanted_effects.begin(), scratch.wanted_effects.end(),
                                               true) != scratch.wanted_effects.end();
    scratch.differentiates_edges = query.Differentiates(first + static_cast<int>(kToeRegion)) ||
                                   query.Differentiates(first + static_cast<int>(kHeelRegion));
    SolePlacesInto(stance, query.parameters, scratch.places);
    scratch.curves = stance.motion_errors.BasesAt(query.parameters);
    // Normal forces do not feel it.
    scratch.shears = PartsFor(wanted) != WrenchParts::kVertical &&
                     (scratch.effects[kShearCompliance] != 0 || scratch.wanted_effects[kShearCompliance]);
    if (scratch.shears) scratch.shear.Begin(scratch.effects[kShearCompliance]);
    for (int t = 0; t < static_cast<int>(stance.time.size()); ++t)
      SINEW_TRY(PredictInstant(stance, t, wanted, query, scratch, prediction));
  }
  return {};
}

Status ContactProblem::PredictInstant(const Stance& stance, int t, const std::array<bool, kChannels>& wanted,
                                      const Query& query, Scratch& scratch, Prediction& prediction) const {
  const bool posed = scratch.posed.has_value();
  const std::size_t first_recorded = stance.RecordedInstants()[0];
  EffectLoadQuery effect_query;
  effect_query.derivatives = query.derivatives;
  effect_query.edges = scratch.differentiates_edges;
  const bool with_effects = !scratch.at_null || scratch.differentiates_effects;
  const auto compute = [&](const EffectKinematics& kinematics, int instant) -> Status {
    if (scratch.shears) {
      // Instants beside the plate's record are there for late sensors and change nothing within it.
      if (static_cast<std::size_t>(t) <= first_recorded) scratch.shear.Begin(scratch.shear.compliance());
      scratch.shear.Next(stance.time[static_cast<std::size_t>(t)]);
      if (!FindShearVelocity(kinematics, instant, scratch.beds, scratch.effects, scratch.shear,
                             scratch.with_effects, effect_query.shear_velocity)) {
        return Fail(
            "trial '{}': at {:.4g} s no friction was found that agrees with a shear compliance of {:.3g} m/N",
            stance.trial, stance.time[static_cast<std::size_t>(t)], scratch.shear.compliance());
      }
    }
    ComputeEffectLoad(kinematics, instant, scratch.beds, scratch.effects, effect_query, scratch.with_effects);
    if (scratch.shears) AcceptShear(effect_query.shear_velocity, scratch.shear, scratch.with_effects);
    return {};
  };
  if (posed) {
    const PoseDeviation deviation = stance.motion_errors.At(scratch.curves, query.parameters, t);
    scratch.posed->Place(stance.kinematics, stance.foot, settings_.floor.height, t, deviation, scratch.places,
                         stance.side, query.derivatives);
    // Without effects the load comes in one pass, with or without their derivatives.
    effect_query.springs = query.derivatives;
    if (with_effects) SINEW_TRY(compute(scratch.posed->kinematics(), 0));
    if (scratch.at_null) {
      scratch.posed->ComputeLoad(stance.foot, scratch.beds, query.derivatives, scratch.with_effects,
                                 scratch.by_pose, scratch.by_place);
    } else if (query.derivatives) {
      scratch.posed->Differentiate(stance.foot, scratch.with_effects, scratch.by_pose, scratch.by_place);
    }
  } else if (with_effects) {
    effect_query.vertical_only = PartsFor(wanted) == WrenchParts::kVertical;
    effect_query.effects = scratch.wanted_effects;
    SINEW_TRY(compute(stance.kinematics, t));
  }
  ContactLoad load = ContactLoad::Zero();
  if (scratch.at_null && !posed) {
    const WrenchParts parts = PartsFor(wanted);
    for (std::size_t p = 0; p < stance.parts.size(); ++p) {
      stance.parts[p].sums.Add(t, scratch.beds[p], parts, scratch.sums[p], load,
                               query.derivatives ? &scratch.by_part[p] : nullptr);
    }
  } else {
    load = scratch.with_effects.load;
  }
  const PlateChannels channels(load, stance.resting_cop);
  for (std::size_t c = 0; c < kChannels; ++c) {
    if (wanted[c]) prediction.values(stance.blocks[c])[t] = channels.value[c];
  }
  if (!query.derivatives) return {};

  const auto& by_part = scratch.at_null && !posed ? scratch.by_part : scratch.with_effects.by_part;
  for (std::size_t p = 0; p < stance.parts.size(); ++p) {
    for (Eigen::Index k = 0; k < kContactParametersPerGroup; ++k) {
      const auto column = static_cast<Eigen::Index>(p) * kContactParametersPerGroup + k;
      const auto slope = channels.Derivative(scratch.Derivative(column, by_part[p].col(k)));
      for (std::size_t c = 0; c < kChannels; ++c) {
        const Eigen::Index columns = kColumnsPerGroup[c];
        if (!wanted[c] || k >= columns) continue;
        prediction.derivatives(stance.blocks[c])(t, static_cast<Eigen::Index>(p) * columns + k) = slope[c];
      }
    }
  }
  if (posed) DifferentiatePose(stance, t, wanted, query, channels, scratch, prediction);
  if (!scratch.differentiates_effects) return {};
  const auto places = static_cast<Eigen::Index>(places_.size() * stance.parts.size());
  const bool own_height = data_.effects.OwnHeight(stance.plate) >= 0;
  for (std::size_t e = 0; e < kContactEffects; ++e) {
    if (!scratch.wanted_effects[e]) continue;
    const auto index = static_cast<Eigen::Index>(e);
    const ContactLoad of_force = scratch.with_effects.by_effect.col(index);
    const auto column =
        static_cast<Eigen::Index>(stance.parts.size()) * kColumnsPerGroup[kFx] + places + index;
    // A mass moves with the foot, whatever the sole does.
    const auto slope =
        channels.Derivative(e == kUnmodelledMass ? of_force : scratch.Derivative(column, of_force));
    for (std::size_t c = 0; c < kChannels; ++c) {
      if (!wanted[c]) continue;
      auto derivatives = prediction.derivatives(stance.blocks[c]);
      const Eigen::Index first =
          static_cast<Eigen::Index>(stance.parts.size()) * kColumnsPerGroup[c] + places;
      derivatives(t, first + static_cast<Eigen::Index>(e)) = slope[c];
      if (e == kHeightOffset && own_height)
        derivatives(t, first + static_cast<Eigen::Index>(kContactEffects)) = slope[c];
    }
  }
  return {};
}

void ContactProblem::DifferentiatePose(const Stance& stance, int t, const std::array<bool, kChannels>& wanted,
                                       const Query& query, const PlateChannels& channels, Scratch& scratch,
                                       Prediction& prediction) const {
  const auto parts = static_cast<Eigen::Index>(stance.parts.size());
  Eigen::Index at = 0;
  for (const int place : places_) {
    for (std::size_t p = 0; p < stance.parts.size(); ++p, ++at) {
      const auto slope = channels.Derivative(
          scratch.Derivative(parts * kColumnsPerGroup[kFx] + at, scratch.by_place[p].col(place)));
      for (std::size_t c = 0; c < kChannels; ++c) {
        if (wanted[c])
          prediction.derivatives(stance.blocks[c])(t, parts * kColumnsPerGroup[c] + at) = slope[c];
      }
    }
  }
  const StanceMotionErrors& errors = stance.motion_errors;
  if (errors.terms.empty()) return;
  at += static_cast<Eigen::Index>(kContactEffects) + (data_.effects.OwnHeight(stance.plate) >= 0 ? 1 : 0);
  for (const PoseTerm& term : errors.terms) {
    const Eigen::Index weights = term.weights;
    if (query.Differentiates(term.first)) {
      const ContactLoad value = scratch.by_pose.leftCols<kPoseComponents>() * term.direction;
      const ContactLoad rate = scratch.by_pose.rightCols<kPoseComponents>() * term.direction;
      const CurveBasis& curves = scratch.curves.Of(term);
      if (scratch.shears && scratch.shear.compliance() > 0) {
        // The memory of the sole is that of every weight.
        for (Eigen::Index w = 0; w < weights; ++w) {
          const auto slope = channels.Derivative(scratch.Derivative(
              parts * kColumnsPerGroup[kFx] + at + w, curves.value(t, w) * value + curves.rate(t, w) * rate));
          for (std::size_t c = 0; c < kChannels; ++c) {
            if (wanted[c])
              prediction.derivatives(stance.blocks[c])(t, parts * kColumnsPerGroup[c] + at + w) = slope[c];
          }
        }
      } else {
        const auto by_value = channels.Derivative(value);
        const auto by_rate = channels.Derivative(rate);
        for (std::size_t c = 0; c < kChannels; ++c) {
          if (!wanted[c]) continue;
          prediction.derivatives(stance.blocks[c]).row(t).segment(parts * kColumnsPerGroup[c] + at, weights) =
              by_value[c] * curves.value.row(t) + by_rate[c] * curves.rate.row(t);
        }
      }
    }
    at += weights;
  }
}

Vector ContactProblem::AtPriors(const Vector& parameters, const Vector& priors, CarryOver how) const {
  Vector at = Problem::AtPriors(parameters, priors, how);
  for (const Stance& stance : data_.stances) {
    const StanceMotionErrors& errors = stance.motion_errors;
    if (errors.terms.empty()) continue;
    for (const PoseTerm& term : errors.terms) {
      if (term.of == DeviationOf::kFloor) continue;
      const DeviationCurves& curves =
          term.of == DeviationOf::kStance ? *errors.own_curves : *errors.common_curves;
      const Vector weights = parameters.segment(term.first, term.weights);
      const CurveSpectrum from = errors.SpectrumAt(parameters, term.of);
      const CurveSpectrum to = errors.SpectrumAt(at, term.of);
      at.segment(term.first, term.weights) =
          how == CarryOver::kSame ? curves.SameCurve(weights, from, to) : curves.Carried(weights, from, to);
    }
  }
  return at;
}

std::vector<Problem::Signal> ContactProblem::ResidualCovariates(int block) const {
  const auto stance = std::find_if(data_.stances.begin(), data_.stances.end(), [&](const Stance& s) {
    return std::find(s.blocks.begin(), s.blocks.end(), block) != s.blocks.end();
  });
  if (stance == data_.stances.end()) return {};
  const Block& of = data_.layout[static_cast<std::size_t>(block)];

  Signal depth{"depth", "m", {}};
  Signal slip{"slip speed", "m/s", {}};
  for (const int t : of.sample) {
    double deepest = -std::numeric_limits<double>::infinity();
    double speed = 0;
    for (const EffectRegion& region : stance->kinematics.regions) {
      const ContactKinematics& k = region.kinematics;
      for (int f = 0; f < k.faces; ++f) {
        const auto i =
            static_cast<std::size_t>(t) * static_cast<std::size_t>(k.faces) + static_cast<std::size_t>(f);
        if (k.depth[i] <= deepest) continue;
        deepest = k.depth[i];
        speed = std::hypot(k.slip_x[i], k.slip_z[i]);
      }
    }
    depth.values.push_back(deepest);
    slip.values.push_back(speed);
  }
  std::vector<Signal> signals{std::move(depth), std::move(slip)};

  // The measured vertical force, if it was measured at every sample of this block.
  const Block& vertical = data_.layout[static_cast<std::size_t>(stance->blocks[kFy])];
  Signal force{"vertical force", "N", {}};
  for (const int t : of.sample) {
    const auto found = std::lower_bound(vertical.sample.begin(), vertical.sample.end(), t);
    if (found == vertical.sample.end() || *found != t) return signals;
    force.values.push_back(vertical.measured[static_cast<std::size_t>(found - vertical.sample.begin())]);
  }
  signals.push_back(std::move(force));
  return signals;
}

std::string ContactProblem::objective() const {
  switch (settings_.objective) {
    case ContactObjective::kThesis:
      return "half the sum of squared errors";
    case ContactObjective::kNormalised:
      return "half the sum over channels of mean squared error / variance of the channel";
    case ContactObjective::kLikelihood:
      return "half the sum of squared errors / noise variance";
  }
  return {};
}

}  // namespace sinew
