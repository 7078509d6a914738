#include "problems/emg_shape/emg_shape_problem.h"

#include <algorithm>
#include <cmath>

#include "base/constants.h"
#include "models/emg/shape_basis.h"
#include "problems/emg_shape/cycle_scatter.h"

namespace sinew {

// Of one block, sample by sample.
struct EmgShapeProblem::Scratch final : Problem::Workspace {
  std::vector<double> gain;    // of the logarithm; later its exponential
  std::vector<double> timing;  // [cycle]
  std::vector<double> offset;
  std::vector<double> control;  // [knots]
  std::vector<double> shape;
  std::vector<double> slope;
  Matrix basis;  // [knots x samples]
  Matrix slopes;
};

EmgShapeProblem::EmgShapeProblem(EmgShapeSettings settings, EmgShapeData data)
    : settings_(std::move(settings)), data_(std::move(data)) {
  list_ = ListEmgShapeParameters(settings_, data_);
  for (const EmgShapeTrial& trial : data_.trials) {
    for (const EmgMuscle& muscle : data_.muscles) {
      // Of fitted trials every burst has its timing. Others are predicted by their mean, which is rounder
      // than a single one.
      const bool mean = settings_.cycle_scatter && trial.role != BlockRole::kTrain;
      const bool timings = mean && muscle.timing_scatter > kLeastTimingScatter;
      basis_.push_back(BasisOf(settings_, trial.period, timings ? muscle.timing_scatter : 0));
    }
  }
  for (std::size_t b = 0; b < data_.layout.size(); ++b) {
    std::vector<int>& columns = data_.layout[b].columns;
    for (const EmgColumn& column : list_.columns[b]) columns.push_back(column.parameter);
    columns.erase(std::unique(columns.begin(), columns.end()), columns.end());
  }
}

Result<std::unique_ptr<EmgShapeProblem>> EmgShapeProblem::Make(const Dataset& data,
                                                               EmgShapeSettings settings) {
  SINEW_ASSIGN(EmgShapeData prepared, PrepareEmgShapeData(data, settings));
  if (prepared.trained_speeds() == 1) {
    prepared.notes.push_back(
        "one speed was measured: nothing says how the EMG changes with speed, the model is the mean of its "
        "cycles");
  }
  std::unique_ptr<EmgShapeProblem> problem(new EmgShapeProblem(std::move(settings), std::move(prepared)));
  SINEW_TRY(CheckParameters(problem->parameters()));
  SINEW_TRY(CheckLayout(problem->layout(), static_cast<int>(problem->parameters().size())));
  return problem;
}

std::unique_ptr<Problem::Workspace> EmgShapeProblem::NewWorkspace() const {
  return std::make_unique<Scratch>();
}

double EmgShapeProblem::Along(const EmgColumn& column, const EmgShapeTrial& trial, std::size_t muscle,
                              std::size_t sample) const {
  switch (column.along) {
    case EmgAlong::kOne:
      return column.factor;
    case EmgAlong::kCycle:
      return column.factor * (trial.cycle[sample] - 0.5 * (static_cast<double>(trial.cycles.size()) - 1));
    case EmgAlong::kSine:
      return column.factor * std::sin(2 * kPi * trial.phase[sample]);
    case EmgAlong::kCosine:
      return column.factor * (std::cos(2 * kPi * trial.phase[sample]) - 1);
    case EmgAlong::kOthers:
      return trial.others[muscle].empty() ? 0 : column.factor * trial.others[muscle][sample];
    case EmgAlong::kHat: {
      const Hats hats = HatsAt(list_.hat_knots, trial.time[sample] - trial.time.front());
      if (column.which == hats.first) return column.factor * hats.left;
      return column.which == hats.first + 1 ? column.factor * hats.right : 0;
    }
  }
  return 0;
}

Status EmgShapeProblem::Predict(const Query& query, Workspace& workspace, Prediction& prediction) const {
  auto& scratch = static_cast<Scratch&>(workspace);
  for (std::size_t t = 0; t < data_.trials.size(); ++t) {
    for (std::size_t m = 0; m < data_.muscles.size(); ++m) {
      const auto block = static_cast<std::size_t>(data_.trials[t].first_block) + m;
      if (query.blocks[block]) PredictBlock(t, m, query, scratch, prediction);
    }
  }
  return {};
}

void EmgShapeProblem::PredictBlock(std::size_t t, std::size_t m, const Query& query, Scratch& scratch,
                                   Prediction& prediction) const {
  const EmgShapeTrial& trial = data_.trials[t];
  const int b = trial.first_block + static_cast<int>(m);
  const std::vector<EmgColumn>& columns = list_.columns[static_cast<std::size_t>(b)];
  const std::size_t count = trial.time.size();
  scratch.gain.assign(count, 0);
  scratch.timing.assign(count, 0);
  scratch.offset.assign(count, 0);
  scratch.control.assign(static_cast<std::size_t>(settings_.knots), 0);
  for (const EmgColumn& column : columns) {
    const double value = query.parameters[column.parameter];
    if (column.term == EmgTerm::kShape) scratch.control[static_cast<std::size_t>(column.which)] = value;
    if (column.term == EmgTerm::kShape || value == 0) continue;
    std::vector<double>& sum = column.term == EmgTerm::kGain     ? scratch.gain
                               : column.term == EmgTerm::kTiming ? scratch.timing
                                                                 : scratch.offset;
    for (auto i = static_cast<std::size_t>(column.first); i < static_cast<std::size_t>(column.end); ++i)
      sum[i] += value * Along(column, trial, m, i);
  }
  scratch.shape.resize(count);
  scratch.slope.resize(count);
  scratch.basis.resize(settings_.knots, static_cast<Eigen::Index>(count));
  scratch.slopes.resize(settings_.knots, static_cast<Eigen::Index>(count));
  const Eigen::Map<const Vector> control(scratch.control.data(), settings_.knots);
  auto values = prediction.values(b);
  for (std::size_t i = 0; i < count; ++i) {
    const auto column = static_cast<Eigen::Index>(i);
    basis_[static_cast<std::size_t>(b)].At(trial.phase[i] + scratch.timing[i],
                                           scratch.basis.col(column).data(),
                                           scratch.slopes.col(column).data());
    scratch.gain[i] = std::exp(scratch.gain[i]);
    scratch.shape[i] = scratch.gain[i] * scratch.basis.col(column).dot(control);
    values[static_cast<Eigen::Index>(i)] = scratch.offset[i] + scratch.shape[i];
  }
  if (!query.derivatives) return;
  for (std::size_t i = 0; i < count; ++i)
    scratch.slope[i] = scratch.gain[i] * scratch.slopes.col(static_cast<Eigen::Index>(i)).dot(control);
  auto derivatives = prediction.derivatives(b);
  const std::vector<int>& order = data_.layout[static_cast<std::size_t>(b)].columns;
  Eigen::Index at = -1;
  std::vector<bool> const* wanted = query.differentiate;
  for (const EmgColumn& column : columns) {
    if (at < 0 || order[static_cast<std::size_t>(at)] != column.parameter) {
      ++at;
      if (query.Differentiates(column.parameter)) derivatives.col(at).setZero();
    }
    if (wanted != nullptr && !(*wanted)[static_cast<std::size_t>(column.parameter)]) continue;
    auto slopes = derivatives.col(at);
    for (auto i = static_cast<std::size_t>(column.first); i < static_cast<std::size_t>(column.end); ++i) {
      double& slope = slopes[static_cast<Eigen::Index>(i)];
      switch (column.term) {
        case EmgTerm::kShape:
          slope += scratch.gain[i] * scratch.basis(column.which, static_cast<Eigen::Index>(i));
          break;
        case EmgTerm::kOffset:
          slope += Along(column, trial, m, i);
          break;
        case EmgTerm::kGain:
          slope += scratch.shape[i] * Along(column, trial, m, i);
          break;
        case EmgTerm::kTiming:
          slope += scratch.slope[i] * Along(column, trial, m, i);
          break;
      }
    }
  }
}

std::vector<Problem::Signal> EmgShapeProblem::SignalsOf(int block) const {
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

std::vector<std::string> EmgShapeProblem::RemarksAt(const Vector& /*parameters*/) const {
  std::vector<std::string> remarks;
  if (data_.trained_speeds() > 0) {
    std::string jitter;
    for (const EmgMuscle& muscle : data_.muscles) {
      jitter += fmt::format("{}{} {:.1f} %, {:.0f} %", jitter.empty() ? "" : "; ", muscle.name,
                            100 * muscle.timing_scatter, 100 * muscle.gain_scatter);
    }
    remarks.push_back("cycles of one speed differ in timing (of a cycle) and size by: " + jitter);
    std::string jitters;
    for (const EmgMuscle& muscle : data_.muscles)
      jitters += fmt::format("{}{}: {:.4g}", jitters.empty() ? "" : ", ", muscle.name, muscle.timing_scatter);
    remarks.push_back(fmt::format(
        "to predict recordings without EMG, state in their settings: reference: {{speed: {:.9g}, period: "
        "{:.9g}}}, jitter: {{{}}}",
        data_.reference.speed, data_.reference.period, jitters));
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
    remarks.push_back(fmt::format(
        "trial '{}' moves at {:.3g} rad/s, outside of the measured {:.3g} .. {:.3g}: its EMG is extrapolated",
        trial.name, trial.speed, slowest, fastest));
  }
  return remarks;
}

}  // namespace sinew
