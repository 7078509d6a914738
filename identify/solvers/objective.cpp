#include "identify/solvers/objective.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sinew::solvers {
namespace {

constexpr long kMaxPointsWithoutCost = 10000;

}  // namespace

double Objective::Take(Evaluator::Outcome outcome, double cost) {
  const bool none_has_a_cost = !std::isfinite(worst_) && evaluator_.failures() >= kMaxPointsWithoutCost;
  if (outcome == Evaluator::Outcome::kStop || none_has_a_cost) stopped_ = true;
  if (outcome != Evaluator::Outcome::kOk) return std::numeric_limits<double>::infinity();
  worst_ = std::max(worst_, cost);
  return cost;
}

double Objective::Cost(const Vector& x) {
  inside_ = x.cwiseMax(0.0).cwiseMin(1.0);
  if (evaluator_.has_best() && inside_ == evaluator_.best().x) {
    return Take(Evaluator::Outcome::kOk, evaluator_.best().cost);
  }
  double cost = 0;
  const Evaluator::Outcome outcome = evaluator_.Cost(inside_, cost, infeasible_);
  return Take(outcome, cost);
}

double Objective::Gradient(const Vector& x, Vector& gradient) {
  inside_ = x.cwiseMax(0.0).cwiseMin(1.0);
  double cost = 0;
  const Evaluator::Outcome outcome = evaluator_.Gradient(inside_, cost, gradient, infeasible_);
  if (outcome != Evaluator::Outcome::kOk) gradient.setZero(x.size());
  return Take(outcome, cost);
}

}  // namespace sinew::solvers
