// The cost as a function that is defined everywhere, for algorithms that need a number at every point.
#pragma once

#include "identify/execution/evaluator.h"

namespace sinew::solvers {

/// Adapts an Evaluator to such algorithms. A point outside the box is clamped into it; a point without
/// prediction costs infinity, and so does every point after the evaluator stopped. It stops the search after
/// 10,000 points none of which has a cost.
class Objective {
 public:
  explicit Objective(Evaluator& evaluator, Evaluator::Infeasible infeasible = Evaluator::Infeasible::kReject)
      : evaluator_(evaluator), infeasible_(infeasible) {}

  /// @param x [n]. The best point so far (at the beginning the start) is not evaluated again.
  double Cost(const Vector& x);
  /// As Cost; gradient [n] is zero where the cost is infinite.
  double Gradient(const Vector& x, Vector& gradient);

  /// True: return at once, because the evaluator stopped or no point has a cost.
  [[nodiscard]] bool stopped() const { return stopped_; }
  /// Largest finite cost so far; -infinity if there is none.
  [[nodiscard]] double worst() const { return worst_; }

 private:
  double Take(Evaluator::Outcome outcome, double cost);

  Evaluator& evaluator_;
  Evaluator::Infeasible infeasible_;
  Vector inside_;
  bool stopped_ = false;
  double worst_ = -std::numeric_limits<double>::infinity();
};

}  // namespace sinew::solvers
