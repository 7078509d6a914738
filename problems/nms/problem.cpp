#include "problems/nms/problem.h"

#include <algorithm>
#include <set>

#include "base/text.h"

namespace sinew {
namespace {

using AllLanes = Dual<kMuscleSlots>;

}  // namespace

struct NmsProblem::Scratch final : Problem::Workspace {
  MuscleTrace<double> plain;
  MuscleTrace<Dual<kFewLanes>> few;
  MuscleTrace<Dual<kSomeLanes>> some;
  MuscleTrace<AllLanes> all;
  Slots slots;
  std::vector<std::vector<Slope>> slopes;        // [muscles]
  std::vector<int> lanes;                        // slots that move, of one muscle
  std::vector<bool> needed;                      // [muscles]
  std::vector<std::vector<FoundLengths>> found;  // [trials][muscles]
  std::vector<double> arm;                       // of one muscle about one joint, as it is at the true angle
};

NmsProblem::NmsProblem(NmsSettings settings, NmsData data, MuscleCurves curves)
    : settings_(std::move(settings)), data_(std::move(data)), curves_(std::move(curves)) {
  for (const std::string& muscle : data_.muscles)
    rest_.push_back(SlotsOf(*settings_.subject.Find(muscle), settings_.model.as_ceinms, data_.rate));
  AddPulls();
  list_ = ListNmsParameters(settings_, data_, rest_);
  ListColumns();
  ListSteps();
}

Result<std::unique_ptr<NmsProblem>> NmsProblem::Make(const Dataset& data, NmsSettings settings,
                                                     const std::vector<std::string>& unmeasured) {
  SINEW_ASSIGN(NmsData prepared, PrepareNmsData(data, settings, unmeasured));
  SINEW_ASSIGN(MuscleCurves curves, CurvesOf(settings.subject, settings.model.as_ceinms));
  std::unique_ptr<NmsProblem> problem(
      new NmsProblem(std::move(settings), std::move(prepared), std::move(curves)));
  SINEW_TRY(CheckParameterList(problem->list_));
  SINEW_TRY(CheckLayout(problem->layout(), static_cast<int>(problem->parameters().size())));
  return problem;
}

void NmsProblem::AddPulls() {
  MuscleModel model = settings_.model;
  model.tendon = TendonMode::kRigid;  // the activation does not depend on it, and it never fails
  MuscleTrace<double> trace;
  for (NmsTrial& trial : data_.trials) {
    const auto frames = static_cast<Eigen::Index>(trial.time.size());
    std::vector<Vector> activation;
    for (std::size_t m = 0; m < data_.muscles.size(); ++m) {
      activation.emplace_back(Vector::Zero(frames));
      if (!ComputeMuscleForce(curves_, model, rest_[m], trial.muscles[m], trace)) continue;
      activation.back() = Eigen::Map<const Vector>(trace.activation.data(), frames);
    }
    for (std::size_t j = 0; j < settings_.joints.size(); ++j) {
      std::array<Vector, 2> pull{Vector::Zero(frames), Vector::Zero(frames)};
      std::array<int, 2> count{};
      for (std::size_t k = 0; k < data_.joint_muscles[j].size(); ++k) {
        const double arm = trial.arms[j][k].mean();
        if (arm == 0) continue;
        const std::size_t side = arm > 0 ? 0 : 1;
        pull[side] += activation[static_cast<std::size_t>(data_.joint_muscles[j][k])];
        ++count[side];
      }
      trial.pull_plus.push_back(pull[0] / std::max(count[0], 1));
      trial.pull_minus.push_back(pull[1] / std::max(count[1], 1));
    }
  }
}

void NmsProblem::ListColumns() {
  for (std::size_t t = 0; t < data_.trials.size(); ++t) {
    for (std::size_t j = 0; j < settings_.joints.size(); ++j) {
      std::vector<int>& columns =
          data_.layout[static_cast<std::size_t>(data_.trials[t].first_block) + j].columns;
      const auto& movers = data_.joint_muscles[j];
      for (const NmsPlace& place : list_.places) {
        if (place.trial >= 0 && place.trial != static_cast<int>(t)) continue;
        if (std::find(movers.begin(), movers.end(), place.muscle) != movers.end())
          columns.push_back(place.parameter);
      }
      for (const NmsMoment& moment : list_.moments) {
        if (moment.joint == static_cast<int>(j)) columns.push_back(moment.parameter);
      }
      if (list_.arm_offset[j] >= 0) columns.push_back(list_.arm_offset[j]);
      std::sort(columns.begin(), columns.end());
      columns.erase(std::unique(columns.begin(), columns.end()), columns.end());
    }
    for (std::size_t m = 0; data_.trials[t].first_fibre_block >= 0 && m < data_.muscles.size(); ++m) {
      std::set<int> columns;
      for (const NmsPlace& place : list_.places) {
        if (place.muscle == static_cast<int>(m) && (place.trial < 0 || place.trial == static_cast<int>(t)))
          columns.insert(place.parameter);
      }
      data_.layout[static_cast<std::size_t>(data_.trials[t].first_fibre_block) + m].columns.assign(
          columns.begin(), columns.end());
    }
  }
}

void NmsProblem::ListSteps() {
  for (std::size_t s = 0; s < settings_.steps.size(); ++s) {
    const NmsStep& asked = settings_.steps[s];
    FitStep step;
    step.name =
        fmt::format("step {} ({}: {})", s + 1, Join(asked.joints, ", "), Join(asked.parameters, ", "));
    const std::vector<std::string> movers = MusclesOf(settings_.subject, asked.joints);
    const auto contains = [](const std::vector<std::string>& names, const std::string& name) {
      return std::find(names.begin(), names.end(), name) != names.end();
    };
    // The first parameters are those of the settings, in their order.
    for (std::size_t p = 0; p < settings_.parameters.size(); ++p) {
      const NmsParameterSetting& setting = settings_.parameters[p];
      const auto& names = MuscleParameterNames();
      const auto name = std::find_if(names.begin(), names.end(),
                                     [&](const MuscleParameterName& n) { return n.slot == setting.slot; });
      const bool moves = std::any_of(setting.muscles.begin(), setting.muscles.end(),
                                     [&](const std::string& muscle) { return contains(movers, muscle); });
      if (moves && contains(asked.parameters, name->name)) step.parameters.push_back(static_cast<int>(p));
    }
    for (std::size_t b = 0; b < data_.layout.size(); ++b) {
      const bool compared = std::any_of(asked.joints.begin(), asked.joints.end(), [&](const auto& joint) {
        return data_.layout[b].channel == joint + "_moment";
      });
      if (compared) step.blocks.push_back(static_cast<int>(b));
    }
    steps_.push_back(std::move(step));
  }
}

std::unique_ptr<Problem::Workspace> NmsProblem::NewWorkspace() const {
  auto scratch = std::make_unique<Scratch>();
  scratch->found.assign(data_.trials.size(), std::vector<FoundLengths>(data_.muscles.size()));
  return scratch;
}

void NmsProblem::SlotsAt(const Vector& parameters, std::size_t trial, Slots& slots,
                         std::vector<std::vector<Slope>>* slopes) const {
  slots = rest_;
  if (slopes != nullptr) {
    slopes->resize(slots.size());
    for (auto& of_muscle : *slopes) of_muscle.clear();
  }
  for (const NmsPlace& place : list_.places) {
    if (place.trial >= 0 && place.trial != static_cast<int>(trial)) continue;
    const double value = parameters[place.parameter];
    double& slot = slots[static_cast<std::size_t>(place.muscle)][place.slot];
    double slope = place.factor;
    std::vector<Slope>* of_muscle =
        slopes == nullptr ? nullptr : &(*slopes)[static_cast<std::size_t>(place.muscle)];
    switch (place.way) {
      case NmsPlace::kSets:
        slot = place.factor * value;
        break;
      case NmsPlace::kAdds:
        if (value != 0) slot += place.factor * value;
        break;
      case NmsPlace::kScales:
        slope = slot;
        if (value != 0) slot *= 1 + value;
        for (std::size_t i = 0; of_muscle != nullptr && i < of_muscle->size(); ++i) {
          if ((*of_muscle)[i].slot == place.slot) (*of_muscle)[i].factor *= 1 + value;
        }
        break;
    }
    if (of_muscle != nullptr) of_muscle->push_back({place.parameter, place.slot, slope});
  }
}

Status NmsProblem::Predict(const Query& query, Workspace& workspace, Prediction& prediction) const {
  auto& scratch = static_cast<Scratch&>(workspace);
  for (std::size_t t = 0; t < data_.trials.size(); ++t)
    SINEW_TRY(PredictTrial(t, query, scratch, prediction));
  return {};
}

Status NmsProblem::PredictTrial(std::size_t t, const Query& query, Scratch& scratch,
                                Prediction& prediction) const {
  const NmsTrial& trial = data_.trials[t];
  scratch.needed.assign(data_.muscles.size(), false);
  bool any = false;
  for (std::size_t j = 0; j < settings_.joints.size(); ++j) {
    const int b = trial.first_block + static_cast<int>(j);
    if (!query.blocks[static_cast<std::size_t>(b)]) continue;
    any = true;
    prediction.values(b).setZero();
    const std::vector<int>& columns = data_.layout[static_cast<std::size_t>(b)].columns;
    for (std::size_t c = 0; c < columns.size() && query.derivatives; ++c) {
      if (query.Differentiates(columns[c]))
        prediction.derivatives(b).col(static_cast<Eigen::Index>(c)).setZero();
    }
    for (const int m : data_.joint_muscles[j]) scratch.needed[static_cast<std::size_t>(m)] = true;
  }
  for (std::size_t m = 0; trial.first_fibre_block >= 0 && m < data_.muscles.size(); ++m) {
    if (!query.blocks[static_cast<std::size_t>(trial.first_fibre_block) + m]) continue;
    scratch.needed[m] = true;
    any = true;
  }
  if (!any) return {};
  SlotsAt(query.parameters, t, scratch.slots, query.derivatives ? &scratch.slopes : nullptr);
  for (std::size_t m = 0; m < data_.muscles.size(); ++m) {
    if (!scratch.needed[m]) continue;
    const Status status = AddMuscle(t, static_cast<int>(m), query, scratch, prediction);
    if (!status) return Fail("trial '{}', {}: {}", trial.name, data_.muscles[m], status.error().message);
  }
  AddMoments(t, query, prediction);
  return {};
}

Status NmsProblem::AddMuscle(std::size_t t, int muscle, const Query& query, Scratch& scratch,
                             Prediction& prediction) const {
  const auto m = static_cast<std::size_t>(muscle);
  scratch.lanes.clear();
  if (query.derivatives) {
    for (const Slope& slope : scratch.slopes[m]) {
      if (query.Differentiates(slope.parameter) &&
          std::find(scratch.lanes.begin(), scratch.lanes.end(), slope.slot) == scratch.lanes.end())
        scratch.lanes.push_back(slope.slot);
    }
  }
  const bool turns =
      query.derivatives && std::any_of(list_.arm_offset.begin(), list_.arm_offset.end(),
                                       [&](int p) { return p >= 0 && query.Differentiates(p); });
  if (scratch.lanes.empty() && !turns) return AddMuscle(t, muscle, query, scratch, scratch.plain, prediction);
  const int moving = static_cast<int>(scratch.lanes.size());
  if (moving <= kFewLanes) return AddMuscle(t, muscle, query, scratch, scratch.few, prediction);
  if (moving <= kSomeLanes) return AddMuscle(t, muscle, query, scratch, scratch.some, prediction);
  return AddMuscle(t, muscle, query, scratch, scratch.all, prediction);
}

template <class T>
Status NmsProblem::AddMuscle(std::size_t t, int muscle, const Query& query, Scratch& scratch,
                             MuscleTrace<T>& trace, Prediction& prediction) const {
  constexpr bool kDerivatives = !std::is_same_v<T, double>;
  const auto m = static_cast<std::size_t>(muscle);
  const NmsTrial& trial = data_.trials[t];
  std::array<T, kMuscleSlots> numbers;
  for (std::size_t slot = 0; slot < kMuscleSlots; ++slot) numbers[slot] = scratch.slots[m][slot];
  std::array<std::size_t, kMuscleSlots> lane_of{};
  if constexpr (kDerivatives) {
    for (std::size_t lane = 0; lane < scratch.lanes.size(); ++lane) {
      const auto slot = static_cast<std::size_t>(scratch.lanes[lane]);
      numbers[slot] = T::Variable(scratch.slots[m][slot], static_cast<int>(lane));
      lane_of[slot] = lane;
    }
  }
  SINEW_TRY(
      ComputeMuscleForce(curves_, settings_.model, numbers, trial.muscles[m], trace, &scratch.found[t][m]));
  AddFibreLength(t, m, numbers[kOptimalLength], trace, query, scratch, prediction);
  const std::vector<T>& force = trace.tendon_force;
  for (std::size_t crossed = 0; crossed < data_.muscle_joints[m].size(); ++crossed) {
    const auto j = static_cast<std::size_t>(data_.muscle_joints[m][crossed]);
    const int b = trial.first_block + static_cast<int>(j);
    if (!query.blocks[static_cast<std::size_t>(b)]) continue;
    const std::size_t turned = kAngleOffset + crossed;
    const int turning = list_.arm_offset[j];
    const double offset = turning >= 0 ? query.parameters[turning] : 0;
    scratch.arm.resize(force.size());
    for (std::size_t i = 0; i < force.size(); ++i)
      scratch.arm[i] = ArmAt(trial.muscles[m], crossed, i, Value(numbers[turned])) + offset;
    const std::vector<double>& arm = scratch.arm;
    auto values = prediction.values(b);
    for (std::size_t i = 0; i < force.size(); ++i)
      values[static_cast<Eigen::Index>(i)] += arm[i] * Value(force[i]);
    if constexpr (kDerivatives) {
      auto derivatives = prediction.derivatives(b);
      const std::vector<int>& columns = data_.layout[static_cast<std::size_t>(b)].columns;
      const auto column = [&](int parameter) {
        return derivatives.col(std::lower_bound(columns.begin(), columns.end(), parameter) - columns.begin());
      };
      for (const Slope& slope : scratch.slopes[m]) {
        if (!query.Differentiates(slope.parameter)) continue;
        auto slot_column = column(slope.parameter);
        const std::size_t lane = lane_of[slope.slot];
        for (std::size_t i = 0; i < force.size(); ++i)
          slot_column[static_cast<Eigen::Index>(i)] += slope.factor * arm[i] * force[i].d[lane];
        if (static_cast<std::size_t>(slope.slot) != turned) continue;
        const std::vector<double>& bend = trial.muscles[m].arm_slopes[crossed];
        for (std::size_t i = 0; i < force.size(); ++i)
          slot_column[static_cast<Eigen::Index>(i)] += slope.factor * bend[i] * force[i].value;
      }
      if (turning < 0 || !query.Differentiates(turning)) continue;
      auto arm_column = column(turning);
      for (std::size_t i = 0; i < force.size(); ++i)
        arm_column[static_cast<Eigen::Index>(i)] += force[i].value;
    }
  }
  return {};
}

template <class T>
void NmsProblem::AddFibreLength(std::size_t t, std::size_t muscle, const T& optimal,
                                const MuscleTrace<T>& trace, const Query& query, const Scratch& scratch,
                                Prediction& prediction) const {
  if (data_.trials[t].first_fibre_block < 0) return;
  const int b = data_.trials[t].first_fibre_block + static_cast<int>(muscle);
  if (!query.blocks[static_cast<std::size_t>(b)]) return;
  const auto count = static_cast<Eigen::Index>(trace.fibre_length.size());
  auto values = prediction.values(b);
  for (Eigen::Index i = 0; i < count; ++i)
    values[i] = Value(trace.fibre_length[static_cast<std::size_t>(i)]) / Value(optimal);
  if (!query.derivatives) return;
  const std::vector<int>& columns = data_.layout[static_cast<std::size_t>(b)].columns;
  auto derivatives = prediction.derivatives(b);
  for (std::size_t c = 0; c < columns.size(); ++c) {
    if (query.Differentiates(columns[c])) derivatives.col(static_cast<Eigen::Index>(c)).setZero();
  }
  if constexpr (!std::is_same_v<T, double>) {
    for (const Slope& slope : scratch.slopes[muscle]) {
      if (!query.Differentiates(slope.parameter)) continue;
      auto column = derivatives.col(std::lower_bound(columns.begin(), columns.end(), slope.parameter) -
                                    columns.begin());
      const auto lane = static_cast<std::size_t>(
          std::find(scratch.lanes.begin(), scratch.lanes.end(), slope.slot) - scratch.lanes.begin());
      for (Eigen::Index i = 0; i < count; ++i) {
        const T& length = trace.fibre_length[static_cast<std::size_t>(i)];
        column[i] += slope.factor * (length.d[lane] - values[i] * optimal.d[lane]) / Value(optimal);
      }
    }
  }
}

void NmsProblem::AddMoments(std::size_t t, const Query& query, Prediction& prediction) const {
  for (const NmsMoment& moment : list_.moments) {
    const int b = data_.trials[t].first_block + moment.joint;
    if (!query.blocks[static_cast<std::size_t>(b)]) continue;
    const double value = query.parameters[moment.parameter];
    if (value != 0) prediction.values(b) += value * moment.by_trial[t];
    if (!query.Differentiates(moment.parameter)) continue;
    const std::vector<int>& columns = data_.layout[static_cast<std::size_t>(b)].columns;
    prediction.derivatives(b).col(std::lower_bound(columns.begin(), columns.end(), moment.parameter) -
                                  columns.begin()) += moment.by_trial[t];
  }
}

void NmsProblem::Excite(std::size_t trial, std::size_t muscle, std::vector<double> time,
                        std::vector<double> excitation) {
  MuscleSignals& signals = data_.trials[trial].muscles[muscle];
  signals.excitation_time = std::move(time);
  signals.excitation = std::move(excitation);
  signals.others.clear();
}

}  // namespace sinew
