// The minimum of a Gauss-Newton model in the box [0, 1]^n with one variable held: what a refit finds where
// the model is right, without an evaluation of the problem.
#pragma once

#include <memory>
#include <vector>

#include "identify/solvers/box_quadratic_model.h"

namespace sinew::solvers {

/// Active sets (Hintermueller, Ito, Kunisch 2003) where they settle, else projected Newton steps (Bertsekas
/// 1982): variables on a bound are held while the model falls beyond it, and are released where it does not.
/// Keeps its last decomposition, which serves as long as the same variables are free: one per point and held
/// variable.
class BoxMinimum {
 public:
  /// Keeps references. @param x [n] the model's point @param held variable that is fixed, or -1
  /// @param damping of the other columns, scaled to unit length (Levenberg 1944, Marquardt 1963)
  BoxMinimum(const BoxQuadraticModel& model, const Vector& x, int held, double damping = 0);
  ~BoxMinimum();
  BoxMinimum(const BoxMinimum&) = delete;
  BoxMinimum& operator=(const BoxMinimum&) = delete;

  /// Change of the model's cost from x to its minimum with step[held] as given.
  /// @param step [n] from x; where the search starts, within the box, and the minimum that it found
  /// @param tolerance gain of the next step at which the search ends, > 0
  double Find(Vector& step, double tolerance);

  /// Derivative of that change for step[held] at the last minimum (by the envelope theorem).
  [[nodiscard]] double slope() const { return slope_; }

 private:
  struct Decomposition;
  [[nodiscard]] Vector Curved(const Vector& step) const;  // normal, damped, times step
  [[nodiscard]] double Value(const Vector& step, const Vector& curved) const;
  // Whether the sets of held variables settled: then step is the minimum.
  bool FindByActiveSets(Vector& step);
  [[nodiscard]] Vector NewtonStep(const std::vector<int>& moving, const Vector& gradient);

  const BoxQuadraticModel& model_;
  const Vector& x_;
  int held_;
  double damping_;
  double slope_ = 0;
  std::unique_ptr<Decomposition> last_;
};

}  // namespace sinew::solvers
