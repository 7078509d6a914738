// A problem whose derivatives are differences of its predictions: for an existing simulator, or a first
// version of a model.
#pragma once

#include <memory>
#include <vector>

#include "identify/problem.h"

namespace sinew {

/// Derive from it, predict values, and leave derivatives out.
///
/// Central differences, parameter by parameter, with a step of cbrt(accuracy()) times the parameter's scale:
/// its magnitude or a thousandth of its range, whichever is larger (on a logarithmic scale: times its
/// magnitude). Where a bound is nearer than a step, three points on the side of the box are used. Both are of
/// order 2: the error of a derivative is about accuracy()^(2/3) of it (4e-11 for values that are exact to
/// rounding, 5e-6 for a simulator accurate to 1e-8), times how strongly the prediction bends. Next to the
/// null of an effect that has a null_step, the slope is the secant over that step.
///
/// Differences run in parallel as far as oneTBB may (--threads), each with a workspace of its own; the answer
/// does not depend on that. A simulator that keeps state outside of the workspace must lock a mutex.
class DifferencedProblem : public Problem {
 public:
  [[nodiscard]] std::unique_ptr<Workspace> NewWorkspace() const final;
  /// Errors: those of PredictValues, also at a neighbouring point.
  Status Predict(const Query& query, Workspace& workspace, Prediction& prediction) const final;

  /// Accuracy of a predicted value, relative to its magnitude, in 1e-16 .. 1e-2: rounding for a formula, the
  /// tolerance of the integrator for a simulation.
  [[nodiscard]] virtual double accuracy() const { return 2e-16; }

 protected:
  /// Predicts every wanted block on its prediction_time: prediction.values(b). As Problem::Predict, without
  /// derivatives. @param workspace made by NewValueWorkspace
  virtual Status PredictValues(const Vector& parameters, const std::vector<bool>& blocks,
                               Workspace& workspace, Prediction& prediction) const = 0;

  [[nodiscard]] virtual std::unique_ptr<Workspace> NewValueWorkspace() const {
    return std::make_unique<Workspace>();
  }

 private:
  struct Scratch;
};

}  // namespace sinew
