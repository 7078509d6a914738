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
constexpr double kSuspicious = 1.5;  // times the largest error of the others, while it is fitted
constexpr double kOdd = 4;  // the same, left out. Of seven measured data sets no trial has more than 2.8.
constexpr double kLeastShare = 0.02;   // of what the channel varies by: less harms no fit
constexpr double kTolerance = 1e-6;    // of the cost, of a refit
constexpr long kMostEvaluations = 40;  // of a refit

// The errors of one channel, trial by trial [unit], and over what it varies by there.
struct Errors {
  double rmse = 0;
  double relative = 0;
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
    errors[block.channel][block.trial] = {rmse, varies > 0 ? rmse / varies : 0};
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
        oddest = {{trial, channel, "", here.rmse, others.rmse, static_cast<int>(of.size())}, ratio};
    }
  }
  return oddest;
}

// The fit of `trials`, and the nuisance parameters of all others as far as they are their own.
std::optional<Vector> Refit(const Problem& problem, const FitSetup& setup, const Vector& parameters,
                            const std::set<std::string>& trials, const std::set<std::string>& all) {
  const RoleView view(problem, [&](const Block& block) {
    if (trials.count(block.trial) > 0) return BlockRole::kTrain;
    return all.count(block.trial) > 0 ? BlockRole::kValidate : BlockRole::kPredicted;
  });
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
  auto with_nuisance = solvers::FitHeldOutNuisance(view, least_squares.Parameters(outcome.x));
  if (!with_nuisance) return {};
  return *with_nuisance;
}

}  // namespace

std::vector<OddTrial> FindOddTrials(const Problem& problem, const FitSetup& setup, const Vector& parameters,
                                    const std::atomic<bool>* interrupt) {
  std::set<std::string> trials;
  for (const Block& block : problem.layout()) {
    if (block.role == BlockRole::kTrain) trials.insert(block.trial);
  }
  const std::set<std::string> all = trials;
  const std::size_t most = trials.size() / kFewestTrials;
  std::vector<std::string> left_out;  // the most suspicious first
  Vector point = parameters;
  // Two wrong trials hide each other: suspects are left out one after the other, and judged at the end.
  while (left_out.size() < most && (interrupt == nullptr || !interrupt->load())) {
    const auto errors = ErrorsAt(problem, point, trials);
    if (!errors) break;
    const Oddest suspect = OddestOf(*errors, "", false);
    if (suspect.ratio < kSuspicious) break;
    std::set<std::string> others = trials;
    others.erase(suspect.what.trial);
    auto without = Refit(problem, setup, point, others, all);
    if (!without) break;
    left_out.push_back(suspect.what.trial);
    trials = std::move(others);
    point = std::move(*without);
  }
  std::vector<OddTrial> found;
  for (const std::string& trial : left_out) {
    std::set<std::string> compared = trials;
    compared.insert(trial);
    const auto errors = ErrorsAt(problem, point, compared);
    if (!errors) continue;
    Oddest odd = OddestOf(*errors, trial, true);
    if (odd.ratio < kOdd) continue;
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
          {odd.rmse, odd.others, static_cast<double>(odd.among)},
          {}};
}

}  // namespace sinew
