#include "identify/solvers/continuation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "identify/solvers/levenberg_marquardt.h"

namespace sinew::solvers {
namespace {

// Of a stage: its minimum is a start only.
constexpr double kStageTolerance = 1e-3;
constexpr int kStageIterations = 30;
// Ratio of successive levels.
constexpr double kSmallestRatio = 1.4;
constexpr double kLargestRatio = 3;

}  // namespace

Search Continuation::DoSolve(Evaluator& evaluator, const Vector& start) const {
  LevenbergMarquardt::Options options;
  options.tolerance = std::max(cost_tolerance_, evaluator.fit().problem().cost_noise_level());
  options.first_damping = first_damping_;
  const LeastSquares& fit = evaluator.fit();
  // The weight with which the data's mean squared residual is 1.
  const auto fitting_weight = [&](double data_cost) {
    return data_cost > 0 ? std::min(1.0, std::sqrt(0.5 * fit.data_rows() / data_cost)) : 1.0;
  };
  Vector x = start;
  int iterations = 0;
  Vector residuals;
  if (!fit.PriorVariables().empty() &&
      evaluator.Residuals(x, residuals, nullptr) == Evaluator::Outcome::kOk) {
    LevenbergMarquardt::Options stage = options;
    stage.tolerance = std::max(kStageTolerance, options.tolerance);
    stage.max_iterations = kStageIterations;
    const NoiseSchedule& schedule = schedule_;
    double weight = schedule.first_weight > 0
                        ? std::min(1.0, schedule.first_weight)
                        : fitting_weight(0.5 * residuals.head(fit.data_rows()).squaredNorm());
    while (weight < 1 && !evaluator.MustStop()) {
      stage.data_weight = weight;
      LevenbergMarquardt::Outcome outcome = LevenbergMarquardt::Minimize(evaluator, x, stage);
      iterations += outcome.search.iterations;
      x = std::move(outcome.x);
      if (outcome.cost > schedule.most_cost) {
        Search given_up;
        given_up.iterations = iterations;
        given_up.stop = {Termination::kSolverFailed,
                         fmt::format("given up: cost {:.4g} at {:.2g} of the weight, above {:.4g}",
                                     outcome.cost, weight, schedule.most_cost)};
        return given_up;
      }
      weight =
          std::min(1.0, schedule.ratio > 0 ? schedule.ratio * weight
                                           : std::clamp(fitting_weight(outcome.data_cost),
                                                        kSmallestRatio * weight, kLargestRatio * weight));
    }
  }
  Search search = LevenbergMarquardt::Minimize(evaluator, x, options).search;
  search.iterations += iterations;
  return search;
}

}  // namespace sinew::solvers
