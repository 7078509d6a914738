// Solver `lm`: Levenberg-Marquardt in a box, for problems whose evaluation is cheap.
#pragma once

#include <limits>

#include "identify/solvers/solver.h"

namespace sinew::solvers {

/// Levenberg 1944, Marquardt 1963 over the box [0, 1]^n, with dense normal equations.
///
/// Every step is solved for the free variables, with those that reach a bound held there (BoxQuadraticModel),
/// so that many active bounds cost no iterations; `ceres` projects its steps instead, and needs many short
/// ones along active bounds. A point without prediction is a rejected step. Points are evaluated with
/// derivatives; after a rejected step without them until one is accepted, which is then evaluated again with
/// derivatives. Stops on the relative change of the cost, predicted or actual, and on the length of the step.
/// Normal equations square the condition number: where columns are collinear to eight digits `ceres` (QR) is
/// more accurate.
///
/// The first damping is relative to the squared length of each column. Nearly Gauss-Newton serves starts that
/// are close to a minimum; 1e-3 keeps the first steps of those that are not from ending at bounds.
class LevenbergMarquardt : public Solver {
 public:
  /// @param within_basin Options::within_basin
  explicit LevenbergMarquardt(double cost_tolerance, double first_damping = 1e-8, bool within_basin = false)
      : cost_tolerance_(cost_tolerance), first_damping_(first_damping), within_basin_(within_basin) {}

  struct Options {
    double tolerance = 1e-12;     ///< relative change of the cost
    double first_damping = 1e-8;  ///< relative
    double data_weight = 1;       ///< factor on the rows of the data, not on those of priors and ranges
    int max_iterations = std::numeric_limits<int>::max();
    /// Rejects steps that gain several times what the model predicts: they end in another basin, for which a
    /// search for the last digits is not meant.
    bool within_basin = false;
  };
  struct Outcome {
    Search search;
    Vector x;
    double cost = 0;       ///< at x, with Options::data_weight
    double data_cost = 0;  ///< half the squared norm of the data's rows at x, without their factor
  };
  /// One search; its cost is that of Options::data_weight, the evaluator records the cost with factor 1.
  static Outcome Minimize(Evaluator& evaluator, const Vector& start, const Options& options);

 private:
  Search DoSolve(Evaluator& evaluator, const Vector& start) const override;

  double cost_tolerance_;
  double first_damping_;
  bool within_basin_;
};

}  // namespace sinew::solvers
