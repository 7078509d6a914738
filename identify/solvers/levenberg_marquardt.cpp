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
// Options::within_basin: of the predicted decrease.
constexpr double kMostGained = 3;
// Below this a step in the unit box is rounding.
constexpr double kSmallestStep = 1e-15;

// The fit with a factor on the rows of the data.
class Weighted {
 public:
  Weighted(Evaluator& evaluator, double weight)
      : evaluator_(evaluator), weight_(weight), jacobian_(evaluator.fit().NewJacobian()) {}

  Evaluator::Outcome Derivatives(const Vector& x, double& cost) {
    const auto outcome = evaluator_.Residuals(x, residuals_, &jacobian_);
    if (outcome != Evaluator::Outcome::kOk) return outcome;
    Weigh();
    for (SparseJacobian::Piece& piece : jacobian_.pieces) {
      if (weight_ != 1 && piece.first_row < evaluator_.fit().data_rows()) piece.values *= weight_;
    }
    cost = 0.5 * residuals_.squaredNorm();
    return outcome;
  }

  Evaluator::Outcome Cost(const Vector& x, double& cost) {
    if (weight_ == 1) return evaluator_.Cost(x, cost);
    const auto outcome = evaluator_.Residuals(x, residuals_, nullptr);
    if (outcome != Evaluator::Outcome::kOk) return outcome;
    Weigh();
    cost = 0.5 * residuals_.squaredNorm();
    return outcome;
  }

  [[nodiscard]] const Vector& residuals() const { return residuals_; }
  [[nodiscard]] const SparseJacobian& jacobian() const { return jacobian_; }
  // Of the last point.
  [[nodiscard]] double data_cost() const { return data_cost_; }

 private:
  void Weigh() {
    const int rows = evaluator_.fit().data_rows();
    data_cost_ = 0.5 * residuals_.head(rows).squaredNorm();
    if (weight_ != 1) residuals_.head(rows) *= weight_;
  }

  Evaluator& evaluator_;
  double weight_;
  Vector residuals_;
  SparseJacobian jacobian_;
  double data_cost_ = 0;
};

}  // namespace

Search LevenbergMarquardt::DoSolve(Evaluator& evaluator, const Vector& start) const {
  Options options;
  options.tolerance = std::max(cost_tolerance_, evaluator.fit().problem().cost_noise_level());
  options.first_damping = first_damping_;
  options.within_basin = within_basin_;
  Outcome outcome = Minimize(evaluator, start, options);
  // The lowest point that was ever evaluated may be in another basin.
  if (within_basin_) outcome.search.answer = {0, outcome.cost, outcome.x};
  return std::move(outcome.search);
}

LevenbergMarquardt::Outcome LevenbergMarquardt::Minimize(Evaluator& evaluator, const Vector& start,
                                                         const Options& options) {
  const double tolerance = options.tolerance;
  Weighted fit(evaluator, options.data_weight);
  Outcome outcome;
  Search& search = outcome.search;
  Vector& x = outcome.x;
  double& cost = outcome.cost;
  x = start;
  BoxQuadraticModel equations;
  if (fit.Derivatives(x, cost) != Evaluator::Outcome::kOk) {
    search.stop = {Termination::kSolverFailed, "no derivatives at the start"};
    return outcome;
  }
  outcome.data_cost = fit.data_cost();
  double damping = options.first_damping;
  double growth = 2;
  bool derivatives_at_x = false;
  while (true) {
    if (!derivatives_at_x) {
      if (!equations.Set(x.size(), fit.residuals(), fit.jacobian())) {
        search.stop = {Termination::kSolverFailed, "the squares of the derivatives overflow"};
        return outcome;
      }
      derivatives_at_x = true;
    }
    double predicted = 0;
    const Vector step = equations.ProjectedStep(x, -1, damping, predicted);
    const double length = step.cwiseAbs().maxCoeff();
    if (length <= kSmallestStep) {
      search.stop = {Termination::kStepSize, fmt::format("step {:.2g} <= {:.2g}", length, kSmallestStep)};
      return outcome;
    }
    if (std::abs(predicted) <= tolerance * cost && growth == 2) {
      search.stop = {Termination::kCostChange, fmt::format("predicted relative cost change {:.2g} <= {:.2g}",
                                                           predicted / cost, tolerance)};
      return outcome;
    }
    if (damping > kLargestDamping) {
      search.stop = {Termination::kSolverFailed,
                     fmt::format("no step lowers the cost, though {:.2g} of it should go", predicted / cost)};
      return outcome;
    }
    if (search.iterations >= options.max_iterations) {
      search.stop = {Termination::kMaxEvaluations, fmt::format("{} iterations", search.iterations)};
      return outcome;
    }
    ++search.iterations;
    const Vector next = (x + step).cwiseMax(0).cwiseMin(1);
    // After a rejected step the next one is likely to be rejected too, so derivatives are computed only once
    // a step is accepted.
    const bool at_once = growth == 2;
    double next_cost = std::numeric_limits<double>::infinity();
    auto evaluated = at_once ? fit.Derivatives(next, next_cost) : fit.Cost(next, next_cost);
    if (evaluated == Evaluator::Outcome::kStop) return outcome;
    const double gained = cost - next_cost;
    const bool leaves = options.within_basin && gained > std::max(kMostGained * predicted, tolerance * cost);
    if (evaluated == Evaluator::Outcome::kOk && gained > 0 && !leaves && !at_once)
      evaluated = fit.Derivatives(next, next_cost);
    if (evaluated == Evaluator::Outcome::kStop) return outcome;
    if (evaluated == Evaluator::Outcome::kFailed || !(gained > 0) || leaves) {
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
    outcome.data_cost = fit.data_cost();
    derivatives_at_x = false;
    if (settled) {
      search.stop = {Termination::kCostChange,
                     fmt::format("relative cost change {:.2g} <= {:.2g}", gained / cost, tolerance)};
      return outcome;
    }
  }
}

}  // namespace sinew::solvers
