#include "problems/nms/nms_problem.h"

#include <algorithm>
#include <cmath>

namespace sinew {
namespace {

using Lanes = Dual<kMuscleSlots>;

Result<MuscleCurves> CurvesOf(const NmsSettings& settings) {
  const auto curve = [&](SubjectCurve which) {
    const CurvePoints& points = settings.subject.curves[which];
    return settings.model.as_ceinms ? MuscleCurve::Natural(points.x, points.y)
                                    : MuscleCurve::Smooth(points.x, points.y);
  };
  SINEW_ASSIGN(auto active, curve(kActiveForceLength));
  SINEW_ASSIGN(auto passive, curve(kPassiveForceLength));
  SINEW_ASSIGN(auto velocity, curve(kForceVelocity));
  SINEW_ASSIGN(auto tendon, curve(kTendonForceStrain));
  return MuscleCurves{std::move(active), std::move(passive), std::move(velocity), std::move(tendon)};
}

}  // namespace

struct NmsProblem::Scratch final : Problem::Workspace {
  MuscleTrace<double> plain;
  MuscleTrace<Lanes> lanes;
  std::vector<std::array<double, kMuscleSlots>> slots;  // [muscles]
};

NmsProblem::NmsProblem(NmsSettings settings, NmsData data, MuscleCurves curves)
    : settings_(std::move(settings)), data_(std::move(data)), curves_(std::move(curves)) {
  for (const std::string& muscle : data_.muscles)
    rest_.push_back(SlotsOf(*settings_.subject.Find(muscle), settings_.model.as_ceinms, data_.rate));
  ListParameters();
}

Result<std::unique_ptr<NmsProblem>> NmsProblem::Make(const Dataset& data, NmsSettings settings) {
  SINEW_ASSIGN(NmsData prepared, PrepareNmsData(data, settings));
  SINEW_ASSIGN(MuscleCurves curves, CurvesOf(settings));
  std::unique_ptr<NmsProblem> problem(
      new NmsProblem(std::move(settings), std::move(prepared), std::move(curves)));
  SINEW_TRY(CheckParameters(problem->parameters()));
  SINEW_TRY(CheckLayout(problem->layout(), static_cast<int>(problem->parameters().size())));
  return problem;
}

void NmsProblem::ListParameters() {
  std::array<int, kMuscleSlots> none{};
  none.fill(-1);
  parameter_of_.assign(data_.muscles.size(), none);
  for (const NmsParameterSetting& setting : settings_.parameters) {
    const auto& names = MuscleParameterNames();
    const auto name = std::find_if(names.begin(), names.end(),
                                   [&](const MuscleParameterName& n) { return n.slot == setting.slot; });
    std::vector<Place> places;
    double start = 0;
    for (const std::string& muscle : setting.muscles) {
      const auto at = std::find(data_.muscles.begin(), data_.muscles.end(), muscle) - data_.muscles.begin();
      const double value = rest_[static_cast<std::size_t>(at)][setting.slot];
      places.push_back({static_cast<int>(at), setting.slot, setting.relative ? value : 1});
      parameter_of_[static_cast<std::size_t>(at)][setting.slot] = static_cast<int>(parameters_.size());
      start += (setting.relative ? 1 : value) / static_cast<double>(setting.muscles.size());
    }
    Parameter parameter =
        BaseParameter(setting.group + "." + name->name, setting.relative ? "1" : name->unit, name->meaning,
                      setting.lower, setting.upper, std::clamp(start, setting.lower, setting.upper));
    if (setting.slot == kFilterMean && !setting.relative)
      parameter.unit = settings_.model.as_ceinms ? "1" : "s";
    if (setting.relative) parameter.meaning += ", as a factor on the subject's";
    parameter.source = name->source;
    parameters_.push_back(std::move(parameter));
    places_.push_back(std::move(places));
  }
  for (std::size_t t = 0; t < data_.trials.size(); ++t) {
    for (std::size_t j = 0; j < settings_.joints.size(); ++j) {
      std::vector<int>& columns =
          data_.layout[static_cast<std::size_t>(data_.trials[t].first_block) + j].columns;
      for (const int m : data_.joint_muscles[j]) {
        for (const int parameter : parameter_of_[static_cast<std::size_t>(m)]) {
          if (parameter >= 0) columns.push_back(parameter);
        }
      }
      std::sort(columns.begin(), columns.end());
      columns.erase(std::unique(columns.begin(), columns.end()), columns.end());
    }
  }
}

std::unique_ptr<Problem::Workspace> NmsProblem::NewWorkspace() const {
  return std::make_unique<Scratch>();
}

std::vector<std::array<double, kMuscleSlots>> NmsProblem::SlotsAt(const Vector& parameters) const {
  auto slots = rest_;
  for (std::size_t p = 0; p < places_.size(); ++p) {
    for (const Place& place : places_[p])
      slots[static_cast<std::size_t>(place.muscle)][place.slot] =
          place.factor * parameters[static_cast<Eigen::Index>(p)];
  }
  return slots;
}

Status NmsProblem::Predict(const Query& query, Workspace& workspace, Prediction& prediction) const {
  auto& scratch = static_cast<Scratch&>(workspace);
  scratch.slots = SlotsAt(query.parameters);
  for (const NmsTrial& trial : data_.trials) {
    std::vector<bool> needed(data_.muscles.size(), false);
    for (std::size_t j = 0; j < settings_.joints.size(); ++j) {
      const int b = trial.first_block + static_cast<int>(j);
      if (!query.blocks[static_cast<std::size_t>(b)]) continue;
      prediction.values(b).setZero();
      const std::vector<int>& columns = data_.layout[static_cast<std::size_t>(b)].columns;
      for (std::size_t c = 0; c < columns.size() && query.derivatives; ++c) {
        if (query.Differentiates(columns[c]))
          prediction.derivatives(b).col(static_cast<Eigen::Index>(c)).setZero();
      }
      for (const int m : data_.joint_muscles[j]) needed[static_cast<std::size_t>(m)] = true;
    }
    for (std::size_t m = 0; m < needed.size(); ++m) {
      if (!needed[m]) continue;
      const auto& slots = scratch.slots[m];
      const auto& own = parameter_of_[m];
      const bool moves =
          std::any_of(own.begin(), own.end(), [&](int p) { return p >= 0 && query.Differentiates(p); });
      Status status;
      if (moves) {
        std::array<Lanes, kMuscleSlots> lanes;
        for (int i = 0; i < kMuscleSlots; ++i)
          lanes[i] = Lanes::Variable(slots[static_cast<std::size_t>(i)], i);
        status = ComputeMuscleForce(curves_, settings_.model, lanes, trial.muscles[m], scratch.lanes);
      } else {
        status = ComputeMuscleForce(curves_, settings_.model, slots, trial.muscles[m], scratch.plain);
        if (status) {
          scratch.lanes.tendon_force.assign(scratch.plain.tendon_force.begin(),
                                            scratch.plain.tendon_force.end());
        }
      }
      if (!status) return Fail("trial '{}', {}: {}", trial.name, data_.muscles[m], status.error().message);
      AddMuscle(trial, static_cast<int>(m), query, scratch, prediction);
    }
  }
  return {};
}

void NmsProblem::AddMuscle(const NmsTrial& trial, int muscle, const Query& query, Scratch& scratch,
                           Prediction& prediction) const {
  const std::vector<Lanes>& force = scratch.lanes.tendon_force;
  const auto& own = parameter_of_[static_cast<std::size_t>(muscle)];
  for (std::size_t j = 0; j < settings_.joints.size(); ++j) {
    const int b = trial.first_block + static_cast<int>(j);
    const auto& movers = data_.joint_muscles[j];
    const auto at = std::find(movers.begin(), movers.end(), muscle);
    if (at == movers.end() || !query.blocks[static_cast<std::size_t>(b)]) continue;
    const Vector& arm = trial.arms[j][static_cast<std::size_t>(at - movers.begin())];
    auto values = prediction.values(b);
    for (Eigen::Index i = 0; i < values.size(); ++i)
      values[i] += arm[i] * force[static_cast<std::size_t>(i)].value;
    if (!query.derivatives) continue;
    auto derivatives = prediction.derivatives(b);
    const std::vector<int>& columns = data_.layout[static_cast<std::size_t>(b)].columns;
    for (std::size_t slot = 0; slot < own.size(); ++slot) {
      const int p = own[slot];
      if (p < 0 || !query.Differentiates(p)) continue;
      const auto column = std::lower_bound(columns.begin(), columns.end(), p) - columns.begin();
      double factor = 1;
      for (const Place& place : places_[static_cast<std::size_t>(p)]) {
        if (place.muscle == muscle) factor = place.factor;
      }
      for (Eigen::Index i = 0; i < values.size(); ++i)
        derivatives(i, column) += factor * arm[i] * force[static_cast<std::size_t>(i)].d[slot];
    }
  }
}

std::string NmsProblem::objective() const {
  if (settings_.objective == NmsObjective::kThesis)
    return "half the sum over trials and joints of the mean squared error of the moment over its variance";
  return Problem::objective();
}

Subject NmsProblem::SubjectAt(const Vector& parameters) const {
  Subject subject = settings_.subject;
  const auto slots = SlotsAt(parameters);
  for (std::size_t m = 0; m < data_.muscles.size(); ++m) {
    for (SubjectMuscle& muscle : subject.muscles) {
      if (muscle.name == data_.muscles[m])
        StoreSlots(slots[m], settings_.model.as_ceinms, data_.rate, muscle);
    }
  }
  return subject;
}

}  // namespace sinew
