#include "identify/solvers/levenberg_marquardt.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "identify/solvers/box_quadratic_model.h"

namespace sinew::solvers {
namespace {

constexpr double kSmallestDamping = 1e-14;
constexpr double kLargestDamping = 1e12;
// Below this a step in the unit box is rounding.
constexpr double kSmallestStep = 1e-15;

}  // namespace

Search LevenbergMarquardt::DoSolve(Evaluator& evaluator, const Vector& start) const {
  const double tolerance = std::max(cost_tolerance_, evaluator.fit().problem().cost_noise_level());
  SparseJacobian jacobian = evaluator.fit().NewJacobian();
  Vector residuals;
  BoxQuadraticModel equations;
  Vector x = start;
  Search search;
  if (evaluator.Residuals(x, residuals, &jacobian) != Evaluator::Outcome::kOk) {
    search.stop = {Termination::kSolverFailed, "no derivatives at the start"};
    return search;
  }
  double cost = 0.5 * residuals.squaredNorm();
  double damping = first_damping_;
  double growth = 2;
  bool derivatives_at_x = false;
  while (true) {
    if (!derivatives_at_x) {
      if (!equations.Set(x.size(), residuals, jacobian)) {
        search.stop = {Termination::kSolverFailed, "the squares of the derivatives overflow"};
        return search;
      }
      derivatives_at_x = true;
    }
    double predicted = 0;
    const Vector step = equations.BoxStep(x, -1, damping, predicted);
    const double length = step.cwiseAbs().maxCoeff();
    if (length <= kSmallestStep) {
      search.stop = {Termination::kStepSize, fmt::format("step {:.2g} <= {:.2g}", length, kSmallestStep)};
      return search;
    }
    if (std::abs(predicted) <= tolerance * cost && growth == 2) {
      search.stop = {Termination::kCostChange, fmt::format("predicted relative cost change {:.2g} <= {:.2g}",
                                                           predicted / cost, tolerance)};
      return search;
    }
    if (damping > kLargestDamping) {
      search.stop = {Termination::kSolverFailed,
                     fmt::format("no step lowers the cost, though {:.2g} of it should go", predicted / cost)};
      return search;
    }
    ++search.iterations;
    const Vector next = (x + step).cwiseMax(0).cwiseMin(1);
    // After a rejected step the next one is likely to be rejected too, so derivatives are computed only once
    // a step is accepted.
    const bool at_once = growth == 2;
    double next_cost = std::numeric_limits<double>::infinity();
    auto outcome =
        at_once ? evaluator.Residuals(next, residuals, &jacobian) : evaluator.Cost(next, next_cost);
    if (outcome == Evaluator::Outcome::kOk && at_once) next_cost = 0.5 * residuals.squaredNorm();
    if (outcome == Evaluator::Outcome::kStop) return search;
    const double gained = cost - next_cost;
    if (outcome == Evaluator::Outcome::kOk && gained > 0 && !at_once)
      outcome = evaluator.Residuals(next, residuals, &jacobian);
    if (outcome == Evaluator::Outcome::kStop) return search;
    if (outcome == Evaluator::Outcome::kFailed || !(gained > 0)) {
      damping *= growth;
      growth *= 2;
      continue;
    }
    const double share = predicted > 0 ? gained / predicted : 1;
    const double trust = 2 * share - 1;
    damping = std::max(kSmallestDamping, damping * std::max(1.0 / 10, 1 - trust * trust * trust));
    growth = 2;
    const bool settled = gained <= tolerance * cost;
    x = next;
    cost = next_cost;
    derivatives_at_x = false;
    if (settled) {
      search.stop = {Termination::kCostChange,
                     fmt::format("relative cost change {:.2g} <= {:.2g}", gained / cost, tolerance)};
      return search;
    }
  }
}

}  // namespace sinew::solvers
