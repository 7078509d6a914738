#include "identify/solvers/regularised_start.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "identify/solvers/local_fit.h"
#include "identify/solvers/marginal_cost.h"
#include "identify/solvers/trial_search.h"

namespace sinew::solvers {
namespace {

constexpr double kLogDeviation = 1;
constexpr double kShareOfValue = 0.5;
constexpr double kShareOfRange = 0.02;
constexpr double kDampingOfStart = 1e-3;
constexpr LocalFit::Tolerance kStartTolerance{0, 1e-4};
constexpr long kStartEvaluations = 100;

bool IsLogarithmic(const Parameter& p) {
  return p.scale == Scale::kLog;
}

bool GetsPrior(const Parameter& p) {
  return !p.prior && p.kind != ParameterKind::kNuisance;
}

double DeviationOf(const Parameter& p, double value) {
  if (IsLogarithmic(p)) return kLogDeviation;
  return std::max(kShareOfValue * std::abs(value), kShareOfRange * (p.upper - p.lower));
}

}  // namespace

FitSetup Regularised(const FitSetup& setup, const Vector& start) {
  FitSetup regularised = setup;
  regularised.rest = start;
  for (const int index : setup.free) {
    Parameter& p = regularised.parameters[static_cast<std::size_t>(index)];
    if (!GetsPrior(p)) continue;
    const double value = start[index];
    p.prior = GaussianPrior{IsLogarithmic(p) ? std::log(value) : value, DeviationOf(p, value)};
  }
  return regularised;
}

Vector DrawnStart(const FitSetup& setup, const Vector& start, Random& random) {
  Vector drawn = start;
  for (const int index : setup.free) {
    const Parameter& p = setup.parameters[static_cast<std::size_t>(index)];
    if (!GetsPrior(p)) continue;
    const double step = DeviationOf(p, start[index]) * random.Normal();
    const double value = IsLogarithmic(p) ? start[index] * std::exp(step) : start[index] + step;
    // Reflected, so that it does not begin on a bound.
    const double inside = value < p.lower   ? 2 * p.lower - value
                          : value > p.upper ? 2 * p.upper - value
                                            : value;
    drawn[index] = std::clamp(inside, p.lower, p.upper);
  }
  return drawn;
}

Vector RegularisedStart(const Evaluator& parent, const Vector& start, const RegularisedSearch& search) {
  const LeastSquares& fit = parent.fit();
  const FitSetup setup = Regularised(fit.setup(), start);
  const LeastSquares regularised(fit.problem(), setup);
  Evaluator::Options options;
  options.interrupt = parent.options().interrupt;
  options.budget.max_seconds = parent.options().budget.max_seconds - parent.seconds();
  Evaluator evaluator(regularised, std::move(options));
  const auto stop = [&] { return parent.StopRequested(); };
  const Continuation continuation(search.cost_tolerance, kDampingOfStart, search.schedule);
  Vector x = continuation.Solve(evaluator, regularised.Start()).x;
  if (!HasCurves(regularised)) return x;
  TrialSearch trials{search.seed, search.threads, false, {}};
  constexpr int kRounds = 2;
  LocalFit local(regularised);
  LocalFit::Outcome end;
  for (int round = 0; round < kRounds && !stop(); ++round) {
    end = local.Minimize(SearchTrials(regularised, x, trials, stop), -1, kStartTolerance, kStartEvaluations);
    if (!end.failure.empty()) return x;
    x = end.x;
  }
  if (stop()) return x;
  return RedrawTrials(regularised, {end.x, end.cost, MarginalCost(regularised, end.x)}, search.seed,
                      search.threads, -std::numeric_limits<double>::infinity(), stop)
      .x;
}

}  // namespace sinew::solvers
