#include "identify/identification/odd_trials.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>

#include "identify/fit_quality.h"
#include "identify/least_squares.h"
#include "identify/role_view.h"
#include "identify/solvers/held_out_nuisance.h"
#include "identify/solvers/local_fit.h"

namespace sinew {
namespace {

constexpr std::size_t kFewestTrials = 3;
constexpr std::size_t kMostLeftOut = 4;
constexpr double kSuspicious = 1.5;  // times the largest error of the others, while it is fitted
constexpr double kOdd = 4;  // the same, left out. Of seven measured data sets no trial has more than 2.8.
constexpr double kLongestLag = 0.3;     // [s] and
constexpr double kLongestShare = 0.15;  // of the trial, that a measurement may be late
constexpr int kLeastLag = 3;            // [samples]
constexpr double kLateOfError = 0.5;    // of the error that is left in step, at most
constexpr double kLagOfOthers = 0.35;   // of the lag, that others may be out of step
constexpr double kLeastShare = 0.02;    // of what the channel varies by: less harms no fit
constexpr double kTolerance = 1e-6;     // of the cost, of a refit
constexpr long kMostEvaluations = 40;   // of a refit

// The errors of one channel, trial by trial [unit], and over what it varies by there.
struct Errors {
  double rmse = 0;
  double relative = 0;
  double late = 0;     // [s] shift of the prediction that fits best
  double least = 0;    // [s] smallest shift that would be told
  double in_step = 0;  // rmse after that shift
};
using ErrorsOfTrials = std::map<std::string, std::map<std::string, Errors>>;  // by channel, trial

double DeviationOf(const std::vector<double>& values) {
  double mean = 0;
  double squares = 0;
  double n = 0;
  for (const double v : values) {
    n += 1;
    const double before = v - mean;
    mean += before / n;
    squares += before * (v - mean);
  }
  return n > 0 ? std::sqrt(squares / n) : 0;
}

// Root mean square error of a prediction that comes `shift` [s] later, over the samples that it reaches.
double ErrorShifted(const Block& block, const Vector& values, double shift, double margin) {
  const std::vector<double>& time = block.prediction_time;
  double squares = 0;
  double n = 0;
  std::size_t at = 1;
  for (std::size_t i = 0; i < block.measured.size(); ++i) {
    const double measured_at = time[static_cast<std::size_t>(block.sample[i])];
    if (measured_at < time.front() + margin || measured_at > time.back() - margin) continue;
    const double t = measured_at - shift;
    while (at + 1 < time.size() && time[at] < t) ++at;
    const double share = (t - time[at - 1]) / (time[at] - time[at - 1]);
    const auto k = static_cast<Eigen::Index>(at);
    squares += std::pow(values[k - 1] + share * (values[k] - values[k - 1]) - block.measured[i], 2);
    n += 1;
  }
  return n > 0 ? std::sqrt(squares / n) : 0;
}

// The shift of the prediction with which it is nearest to the measurement.
void FindShift(const Block& block, const Vector& values, Errors& errors) {
  const std::vector<double>& time = block.prediction_time;
  if (time.size() < 30) return;
  const double duration = time.back() - time.front();
  const double step = duration / static_cast<double>(time.size() - 1);
  const double longest = std::min(kLongestLag, kLongestShare * duration);
  errors.least = kLeastLag * step;
  errors.in_step = INFINITY;
  double unshifted = 0;
  for (int k = -static_cast<int>(longest / step); k * step <= longest; ++k) {
    const double error = ErrorShifted(block, values, k * step, longest);
    if (k == 0) unshifted = error;
    if (error < errors.in_step) {
      errors.in_step = error;
      errors.late = k * step;
    }
  }
  if (errors.in_step > kLateOfError * unshifted) errors.late = 0;
}

Result<ErrorsOfTrials> ErrorsAt(const Problem& problem, const Vector& parameters,
                                const std::set<std::string>& trials) {
  SINEW_ASSIGN(const FullPrediction full, PredictAll(problem, parameters));
  ErrorsOfTrials errors;
  for (std::size_t b = 0; b < problem.layout().size(); ++b) {
    const Block& block = problem.layout()[b];
    if (trials.count(block.trial) == 0 || block.samples() == 0) continue;
    const Eigen::Index n = block.samples();
    double squares = 0;
    for (Eigen::Index i = 0; i < n; ++i) {
      const auto at = static_cast<std::size_t>(i);
      squares += std::pow(full.values[b][block.sample[at]] - block.measured[at], 2);
    }
    const double rmse = std::sqrt(squares / static_cast<double>(n));
    const double varies = DeviationOf(block.measured);
    Errors& here = errors[block.channel][block.trial];
    here.rmse = rmse;
    here.relative = varies > 0 ? rmse / varies : 0;
    FindShift(block, full.values[b], here);
  }
  return errors;
}

struct Oddest {
  OddTrial what;
  double ratio = 0;
};

// The trial whose error in a channel exceeds that of every other one by the largest factor. @param only
// empty: of all trials @param strict also over what the channel varies by: a trial of large motion has large
// errors
Oddest OddestOf(const ErrorsOfTrials& errors, const std::string& only, bool strict) {
  Oddest oddest;
  for (const auto& [channel, of] : errors) {
    if (of.size() < kFewestTrials) continue;
    for (const auto& [trial, here] : of) {
      if ((!only.empty() && trial != only) || here.relative < kLeastShare) continue;
      Errors others;
      for (const auto& [other, there] : of) {
        if (other == trial) continue;
        others.rmse = std::max(others.rmse, there.rmse);
        others.relative = std::max(others.relative, there.relative);
      }
      if (!(others.rmse > 0 && others.relative > 0)) continue;
      double ratio = here.rmse / others.rmse;
      if (strict) ratio = std::min(ratio, here.relative / others.relative);
      if (ratio > oddest.ratio)
        oddest = {{trial, channel, "", here.rmse, others.rmse, static_cast<int>(of.size()), 0}, ratio};
    }
  }
  return oddest;
}

// The trial that is most out of step while the others are in step. Ratio: its lag over the smallest that is
// told.
Oddest LatestOf(const ErrorsOfTrials& errors, const std::string& only) {
  Oddest latest;
  for (const auto& [channel, of] : errors) {
    if (of.size() < kFewestTrials) continue;
    for (const auto& [trial, here] : of) {
      if ((!only.empty() && trial != only) || here.relative < kLeastShare || !(here.least > 0)) continue;
      const double ratio = std::abs(here.late) / here.least;
      if (ratio < 1 || ratio <= latest.ratio) continue;
      double others = 0;
      for (const auto& [other, there] : of) {
        if (other != trial) others = std::max(others, std::abs(there.late));
      }
      if (others > kLagOfOthers * std::abs(here.late)) continue;
      latest = {{trial, channel, "", here.rmse, here.in_step, static_cast<int>(of.size()), here.late}, ratio};
    }
  }
  return latest;
}

// The problem with `trials` fitted and the rest of `all` held out; all others are not compared.
RoleView Split(const Problem& problem, const std::set<std::string>& trials,
               const std::set<std::string>& all) {
  return {problem, [&](const Block& block) {
            if (trials.count(block.trial) > 0) return BlockRole::kTrain;
            return all.count(block.trial) > 0 ? BlockRole::kValidate : BlockRole::kPredicted;
          }};
}

// The fit of `trials`; values of other trials stay.
std::optional<Vector> Refit(const Problem& problem, const FitSetup& setup, const Vector& parameters,
                            const std::set<std::string>& trials) {
  const RoleView view = Split(problem, trials, trials);
  FitSetup part = setup;
  part.rest = parameters;
  part.free.clear();
  for (const int index : setup.free) {
    const Parameter& p = setup.parameters[static_cast<std::size_t>(index)];
    if (p.trial.empty() || trials.count(p.trial) > 0) part.free.push_back(index);
  }
  if (part.free.empty()) return {};
  const LeastSquares least_squares(view, part);
  solvers::LocalFit fit(least_squares);
  const auto outcome = fit.Minimize(least_squares.Start(), -1, {0, kTolerance}, kMostEvaluations);
  if (!outcome.failure.empty()) return {};
  return least_squares.Parameters(outcome.x);
}

}  // namespace

std::vector<OddTrial> FindOddTrials(const Problem& problem, const FitSetup& setup, const Vector& parameters,
                                    const std::atomic<bool>* interrupt) {
  std::set<std::string> trials;
  for (const Block& block : problem.layout()) {
    if (block.role == BlockRole::kTrain) trials.insert(block.trial);
  }
  const std::set<std::string> all = trials;
  const std::size_t most = std::min(trials.size() / kFewestTrials, kMostLeftOut);
  std::vector<std::string> left_out;  // the most suspicious first
  Vector point = parameters;
  // Two wrong trials hide each other: suspects are left out one after the other, and judged at the end.
  while (left_out.size() < most && (interrupt == nullptr || !interrupt->load())) {
    const auto errors = ErrorsAt(problem, point, trials);
    if (!errors) break;
    Oddest suspect = OddestOf(*errors, "", false);
    if (suspect.ratio < kSuspicious) suspect = LatestOf(*errors, "");
    if (suspect.ratio == 0) break;
    std::set<std::string> others = trials;
    others.erase(suspect.what.trial);
    auto without = Refit(problem, setup, point, others);
    if (!without) break;
    left_out.push_back(suspect.what.trial);
    trials = std::move(others);
    point = std::move(*without);
  }
  std::vector<OddTrial> found;
  if (left_out.empty()) return found;
  point = solvers::FitHeldOutNuisance(Split(problem, trials, all), point, setup.record);
  for (const std::string& trial : left_out) {
    std::set<std::string> compared = trials;
    compared.insert(trial);
    const auto errors = ErrorsAt(problem, point, compared);
    if (!errors) continue;
    Oddest odd = OddestOf(*errors, trial, true);
    if (odd.ratio < kOdd) odd = LatestOf(*errors, trial);
    if (odd.ratio == 0) continue;
    for (const Block& block : problem.layout()) {
      if (block.trial == trial && block.channel == odd.what.channel) odd.what.unit = block.unit;
    }
    found.push_back(std::move(odd.what));
  }
  return found;
}

Warning ToWarning(const OddTrial& odd) {
  return {WarningKind::kOddTrial,
          {odd.channel, odd.trial, odd.unit},
          {odd.rmse, odd.others, static_cast<double>(odd.among), odd.late},
          {}};
}

}  // namespace sinew
