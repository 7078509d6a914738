#include "problems/emg_shape/emg_shape_problem.h"

#include <algorithm>
#include <cmath>

#include "base/constants.h"
#include "models/emg/shape_basis.h"
#include "problems/emg_shape/cycle_scatter.h"

namespace sinew {

// Of one block.
struct EmgShapeProblem::Scratch final : Problem::Workspace {
  // Sample by sample.
  std::vector<double> gain;    // of the logarithm
  std::vector<double> timing;  // [cycle]
  std::vector<double> offset;
  Vector by_gain;  // derivatives
  Vector by_timing;
  Vector by_cross_talk;
  Matrix by_shape;  // [knots x samples]
  // Window by window.
  std::vector<double> window_gain;
  std::vector<double> window_timing;
  std::vector<double> shared_timing;   // not the muscle's own
  std::vector<Vector> by_window_gain;  // from the window's first sample on
  std::vector<Vector> by_window_timing;
  Vector control;  // [knots]
  Vector basis;    // [knots] at one sample
  Vector slopes;
  Vector others;  // the same of the others' mean
  Vector others_slopes;
  double cross_talk = 0;
};

namespace {

// How much of the others' mean there is in a burst, of the muscle's own.
double HeardIn(const EmgWindow& window, const EmgShapeTrial& trial, const ShapeBasis& basis,
               const Vector& own, const Vector& others) {
  double products = 0;
  double squares = 0;
  for (int i = window.first; i < window.end; ++i) {
    const auto at = static_cast<std::size_t>(i);
    const double share = window.ShareAt(trial.cycle[at] + trial.phase[at]).value;
    if (share == 0) continue;
    const double emg = share * basis.Value(trial.phase[at], own.data());
    products += emg * share * basis.Value(trial.phase[at], others.data());
    squares += emg * emg;
  }
  return squares > 0 ? products / squares : 0;
}

// Where there are no windows, all is one.
std::vector<EmgWindow> WindowsOf(const EmgShapeTrial& trial, std::size_t muscle) {
  if (!trial.windows[muscle].empty()) return trial.windows[muscle];
  EmgWindow all;
  all.end = static_cast<int>(trial.time.size());
  return {all};
}

}  // namespace

EmgShapeProblem::EmgShapeProblem(EmgShapeSettings settings, EmgShapeData data)
    : settings_(std::move(settings)), data_(std::move(data)), plain_(data_.knots) {
  list_ = ListEmgShapeParameters(settings_, data_);
  for (const EmgShapeTrial& trial : data_.trials) {
    for (std::size_t m = 0; m < data_.muscles.size(); ++m) {
      // Of fitted trials every burst has its timing. Others are predicted by their mean, which is rounder
      // than a single one.
      const double scatter = data_.muscles[m].timing.total;
      const bool mean = settings_.cycle_scatter && trial.role != BlockRole::kTrain;
      const bool timings = mean && scatter > kLeastTimingScatter;
      basis_.push_back(BasisOf(settings_, data_.knots, trial.period, timings ? scatter : 0));
      heard_.emplace_back();
      for (const EmgWindow& window : WindowsOf(trial, m)) {
        const bool known = !trial.others[m].empty() && !trial.windows[m].empty();
        heard_.back().push_back(
            known ? HeardIn(window, trial, plain_, data_.muscles[m].mean_shape, data_.others_shape[m]) : 0);
      }
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

double EmgShapeProblem::Along(const EmgColumn& column, const EmgShapeTrial& trial, std::size_t sample) const {
  switch (column.along) {
    case EmgAlong::kOne:
    case EmgAlong::kWindow:
    case EmgAlong::kAllMuscles:
      return column.factor;
    case EmgAlong::kCycle:
      return column.factor * (trial.cycle[sample] - 0.5 * (static_cast<double>(trial.cycles.size()) - 1));
    case EmgAlong::kSine:
      return column.factor * std::sin(2 * kPi * trial.phase[sample]);
    case EmgAlong::kCosine:
      return column.factor * (std::cos(2 * kPi * trial.phase[sample]) - 1);
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

// Sums of the parameters, sample by sample and window by window.
void EmgShapeProblem::AddUp(std::size_t t, std::size_t m, const Vector& parameters, Scratch& scratch) const {
  const EmgShapeTrial& trial = data_.trials[t];
  const std::size_t count = trial.time.size();
  scratch.gain.assign(count, 0);
  scratch.timing.assign(count, 0);
  scratch.offset.assign(count, 0);
  scratch.window_gain.assign(std::max<std::size_t>(1, trial.windows[m].size()), 0);
  scratch.window_timing.assign(scratch.window_gain.size(), 0);
  scratch.shared_timing.assign(scratch.window_gain.size(), 0);
  scratch.control = Vector::Zero(data_.knots);
  scratch.cross_talk = 0;
  for (const EmgColumn& column : list_.columns[static_cast<std::size_t>(trial.first_block) + m]) {
    const double value = parameters[column.parameter];
    if (column.term == EmgTerm::kShape) scratch.control[column.which] = value;
    if (column.term == EmgTerm::kCrossTalk && !trial.others[m].empty()) scratch.cross_talk = value;
    if (column.term == EmgTerm::kShape || column.term == EmgTerm::kCrossTalk || value == 0) continue;
    if (column.along == EmgAlong::kWindow) {
      auto& sums = column.term == EmgTerm::kGain ? scratch.window_gain : scratch.window_timing;
      sums[static_cast<std::size_t>(column.which)] += value * column.factor;
      continue;
    }
    if (column.along == EmgAlong::kAllMuscles) {
      scratch.shared_timing[static_cast<std::size_t>(column.which)] += value * column.factor;
      continue;
    }
    std::vector<double>& sum = column.term == EmgTerm::kGain     ? scratch.gain
                               : column.term == EmgTerm::kTiming ? scratch.timing
                                                                 : scratch.offset;
    for (std::size_t i = 0; i < count; ++i) sum[i] += value * Along(column, trial, i);
  }
}

void EmgShapeProblem::PredictBlock(std::size_t t, std::size_t m, const Query& query, Scratch& scratch,
                                   Prediction& prediction) const {
  const EmgShapeTrial& trial = data_.trials[t];
  const int b = trial.first_block + static_cast<int>(m);
  AddUp(t, m, query.parameters, scratch);
  const auto count = static_cast<Eigen::Index>(trial.time.size());
  const std::vector<EmgWindow> windows = WindowsOf(trial, m);
  const std::vector<double>& heard = heard_[static_cast<std::size_t>(b)];
  auto values = prediction.values(b);
  values = Eigen::Map<const Vector>(scratch.offset.data(), count);
  if (query.derivatives) {
    scratch.by_gain = scratch.by_timing = scratch.by_cross_talk = Vector::Zero(count);
    scratch.by_shape = Matrix::Zero(data_.knots, count);
    scratch.by_window_gain.resize(windows.size());
    scratch.by_window_timing.resize(windows.size());
  }
  scratch.basis.resize(data_.knots);
  scratch.slopes.resize(data_.knots);
  scratch.others.resize(data_.knots);
  scratch.others_slopes.resize(data_.knots);
  const double cross_talk = scratch.cross_talk;
  const bool hears = !trial.others[m].empty() && (cross_talk != 0 || query.derivatives);
  for (std::size_t w = 0; w < windows.size(); ++w) {
    const EmgWindow& window = windows[w];
    const double scattering = 1 + cross_talk * heard[w];
    if (query.derivatives)
      scratch.by_window_gain[w] = scratch.by_window_timing[w] = Vector::Zero(window.end - window.first);
    for (int i = window.first; i < window.end; ++i) {
      const auto at = static_cast<std::size_t>(i);
      const double early = scratch.shared_timing[w] + scattering * scratch.window_timing[w];
      const BurstCut::Share share =
          window.ShareAt(trial.cycle[at] + trial.phase[at] + scratch.timing[at] + early);
      if (share.value == 0) continue;
      basis_[static_cast<std::size_t>(b)].At(trial.phase[at] + scratch.timing[at] + early,
                                             scratch.basis.data(),
                                             query.derivatives ? scratch.slopes.data() : nullptr);
      const double gain = std::exp(scratch.gain[at] + scattering * scratch.window_gain[w]);
      double shape = scratch.basis.dot(scratch.control);
      double others = 0;
      double others_slope = 0;
      if (hears) {
        plain_.At(trial.phase[at] + scratch.timing[at] + early, scratch.others.data(),
                  scratch.others_slopes.data());
        others = scratch.others.dot(data_.others_shape[m]);
        others_slope = scratch.others_slopes.dot(data_.others_shape[m]);
        shape -= cross_talk * others;
      }
      const double emg = gain * shape;
      values[i] += share.value * emg;
      if (!query.derivatives) continue;
      const double slope =
          share.value * gain * (scratch.slopes.dot(scratch.control) - cross_talk * others_slope);
      const double by_timing = slope + share.slope * emg;
      scratch.by_cross_talk[i] +=
          heard[w] * (scratch.window_gain[w] * share.value * emg + scratch.window_timing[w] * by_timing) -
          share.value * gain * others;
      scratch.by_gain[i] += share.value * emg;
      scratch.by_shape.col(i) += share.value * gain * scratch.basis;
      scratch.by_window_gain[w][i - window.first] = share.value * emg;
      scratch.by_window_timing[w][i - window.first] = by_timing;
      scratch.by_timing[i] += by_timing;
    }
  }
  if (hears) {
    const Eigen::Map<const Vector> heard_now(trial.others[m].data(), count);
    if (cross_talk != 0) values += cross_talk * heard_now;
    if (query.derivatives) scratch.by_cross_talk += heard_now;
  }
  if (query.derivatives) Differentiate(t, m, query, windows, scratch, prediction);
}

void EmgShapeProblem::Differentiate(std::size_t t, std::size_t m, const Query& query,
                                    const std::vector<EmgWindow>& windows, const Scratch& scratch,
                                    Prediction& prediction) const {
  const EmgShapeTrial& trial = data_.trials[t];
  const int b = trial.first_block + static_cast<int>(m);
  auto derivatives = prediction.derivatives(b);
  const std::vector<int>& order = data_.layout[static_cast<std::size_t>(b)].columns;
  Eigen::Index at = -1;
  for (const EmgColumn& column : list_.columns[static_cast<std::size_t>(b)]) {
    const bool wanted = query.Differentiates(column.parameter);
    if (at < 0 || order[static_cast<std::size_t>(at)] != column.parameter) {
      ++at;
      if (wanted) derivatives.col(at).setZero();
    }
    if (!wanted) continue;
    auto slopes = derivatives.col(at);
    if (column.along == EmgAlong::kWindow || column.along == EmgAlong::kAllMuscles) {
      const auto w = static_cast<std::size_t>(column.which);
      const bool gain = column.term == EmgTerm::kGain;
      const Vector& by = gain ? scratch.by_window_gain[w] : scratch.by_window_timing[w];
      // The gain and the timing of the muscle's own part scatter more than those of what is measured.
      const bool own = column.along == EmgAlong::kWindow;
      const double scattering = own ? 1 + scratch.cross_talk * heard_[static_cast<std::size_t>(b)][w] : 1;
      slopes.segment(windows[w].first, by.size()) += column.factor * scattering * by;
      continue;
    }
    if (column.term == EmgTerm::kShape) {
      slopes += scratch.by_shape.row(column.which).transpose();
      continue;
    }
    for (Eigen::Index i = 0; i < slopes.size(); ++i) {
      const double by = column.term == EmgTerm::kGain        ? scratch.by_gain[i]
                        : column.term == EmgTerm::kTiming    ? scratch.by_timing[i]
                        : column.term == EmgTerm::kCrossTalk ? scratch.by_cross_talk[i]
                                                             : 1;
      slopes[i] += by * Along(column, trial, static_cast<std::size_t>(i));
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
                            100 * muscle.timing.total, 100 * muscle.gain.total);
    }
    remarks.push_back("cycles of one speed differ in timing (of a cycle) and size by: " + jitter);
    std::string jitters;
    for (const EmgMuscle& muscle : data_.muscles)
      jitters += fmt::format("{}{}: {:.4g}", jitters.empty() ? "" : ", ", muscle.name, muscle.timing.total);
    remarks.push_back(fmt::format(
        "to predict recordings without EMG, state in their settings: reference: {{speed: {:.9g}, period: "
        "{:.9g}}}, knots: {}, jitter: {{{}}}",
        data_.reference.speed, data_.reference.period, data_.knots, jitters));
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
