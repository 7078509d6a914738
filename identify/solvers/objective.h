// The cost as searches without residuals see it: a number for every point they may think of.
#pragma once

#include "identify/execution/evaluator.h"

namespace sinew {

/// An Evaluator for searches that want numbers. A point outside the box is clamped into it; a point without
/// prediction costs infinity, and so does every point after the evaluator said stop. After 10,000 points of
/// which none has a cost it gives up.
class Objective {
 public:
  explicit Objective(Evaluator& evaluator, Evaluator::Infeasible infeasible = Evaluator::Infeasible::kReject)
      : evaluator_(evaluator), infeasible_(infeasible) {}

  /// @param x [n]. The best point so far (the start, when a search begins) is not evaluated again.
  double Cost(const Vector& x);
  /// As Cost; gradient [n] is zero where the cost is infinite.
  double Gradient(const Vector& x, Vector& gradient);

  /// The evaluator said stop, or there is no hope: return at once.
  [[nodiscard]] bool stopped() const { return stopped_; }
  /// Largest finite cost seen, or nothing yet: -infinity.
  [[nodiscard]] double worst() const { return worst_; }

 private:
  double Take(Evaluator::Outcome outcome, double cost);

  Evaluator& evaluator_;
  Evaluator::Infeasible infeasible_;
  Vector inside_;
  bool stopped_ = false;
  double worst_ = -std::numeric_limits<double>::infinity();
};

}  // namespace sinew
