#include "problems/emg_shape/problem.h"

#include <algorithm>
namespace sinew {

EmgShapeProblem::EmgShapeProblem(EmgShapeSettings settings, EmgShapeData data)
    : settings_(std::move(settings)), data_(std::move(data)) {
  list_ = ListEmgShapeParameters(settings_, data_);
  for (std::size_t b = 0; b < data_.layout.size(); ++b) {
    std::vector<int>& columns = data_.layout[b].columns;
    for (const EmgColumn& column : list_.columns[b]) columns.push_back(column.parameter);
    columns.erase(std::unique(columns.begin(), columns.end()), columns.end());
  }
  for (std::size_t t = 0; t < data_.trials.size(); ++t) {
    for (std::size_t m = 0; m < data_.muscles.size(); ++m)
      blocks_.emplace_back(settings_, data_, list_, t, m);
  }
}

Result<std::unique_ptr<EmgShapeProblem>> EmgShapeProblem::Make(const Dataset& data,
                                                               EmgShapeSettings settings) {
  SINEW_ASSIGN(EmgShapeData prepared, PrepareEmgShapeData(data, settings));
  if (prepared.trained_speeds() == 1) {
    prepared.notes.push_back(
        "only one speed was measured: changes of the EMG with speed are unknown, the model is the mean of "
        "its "
        "cycles");
  }
  std::unique_ptr<EmgShapeProblem> problem(new EmgShapeProblem(std::move(settings), std::move(prepared)));
  SINEW_TRY(CheckParameterList(problem->list_));
  SINEW_TRY(CheckLayout(problem->layout(), static_cast<int>(problem->parameters().size())));
  return problem;
}

std::unique_ptr<Problem::Workspace> EmgShapeProblem::NewWorkspace() const {
  return std::make_unique<EmgBlock::Scratch>();
}

Status EmgShapeProblem::Predict(const Query& query, Workspace& workspace, Prediction& prediction) const {
  auto& scratch = static_cast<EmgBlock::Scratch&>(workspace);
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    if (query.blocks[b]) blocks_[b].Predict(query, scratch, prediction);
  }
  return {};
}

std::vector<Problem::Signal> EmgShapeProblem::ResidualCovariates(int block) const {
  const Block& of = data_.layout[static_cast<std::size_t>(block)];
  const auto trial = std::find_if(data_.trials.begin(), data_.trials.end(),
                                  [&](const EmgShapeTrial& t) { return t.name == of.trial; });
  std::vector<Signal> signals{{"angle", "rad", {}}, {"phase", "1", {}}, {"cycle", "1", {}}};
  for (const int i : of.sample) {
    const auto at = static_cast<std::size_t>(i);
    signals[0].values.push_back(trial->angle[at]);
    signals[1].values.push_back(trial->phase[at]);
    signals[2].values.push_back(trial->cycle[at]);
  }
  return signals;
}

std::vector<Warning> EmgShapeProblem::WarningsAt(const Vector& /*parameters*/) const {
  std::vector<Warning> warnings;
  const auto warn = [&](std::string message) -> Warning& {
    warnings.push_back({WarningKind::kOther, {}, {}, std::move(message)});
    return warnings.back();
  };
  if (data_.trained_speeds() > 0) {
    std::string scatter;
    std::string jitters;
    std::vector<std::string> names{"reference.speed", "reference.period", "knots"};
    std::vector<double> numbers{data_.reference.speed, data_.reference.period,
                                static_cast<double>(data_.knots)};
    for (const EmgMuscle& muscle : data_.muscles) {
      scatter += fmt::format("{}{} {:.1f} %, {:.0f} %", scatter.empty() ? "" : "; ", muscle.name,
                             100 * muscle.timing.total, 100 * muscle.gain.total);
      jitters += fmt::format("{}{}: {:.4g}", jitters.empty() ? "" : ", ", muscle.name, muscle.timing.total);
      names.push_back("jitter." + muscle.name);
      numbers.push_back(muscle.timing.total);
    }
    warn("cycles of one speed differ in timing (of a cycle) and size by: " + scatter);
    Warning& settings = warn(fmt::format(
        "to predict recordings without EMG, state in their settings: reference: {{speed: {:.9g}, period: "
        "{:.9g}}}, knots: {}, jitter: {{{}}}",
        data_.reference.speed, data_.reference.period, data_.knots, jitters));
    settings.names = std::move(names);
    settings.numbers = std::move(numbers);
  }
  double slowest = 0;
  double fastest = 0;
  for (const EmgSpeed& speed : data_.speeds) {
    if (!speed.trained) continue;
    if (slowest == 0) slowest = speed.speed;
    fastest = speed.speed;
  }
  for (const EmgShapeTrial& trial : data_.trials) {
    if (slowest == 0 || (trial.speed >= slowest * (1 - settings_.same_speed) &&
                         trial.speed <= fastest * (1 + settings_.same_speed)))
      continue;
    warn(fmt::format(
        "trial '{}' moves at {:.3g} rad/s, outside of the measured {:.3g} .. {:.3g}: its EMG is extrapolated",
        trial.name, trial.speed, slowest, fastest));
  }
  return warnings;
}

}  // namespace sinew
