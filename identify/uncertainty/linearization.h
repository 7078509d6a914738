// The linearised fit at its solution: residuals, Jacobian, and the status of each free variable.
#pragma once

#include <string>
#include <vector>

#include "base/error.h"
#include "base/linear_algebra.h"
#include "identify/least_squares.h"

namespace sinew::uncertainty {

/// Status of a free variable at the solution.
enum class VariableStatus {
  kInside,        ///< within its bounds, and some fitted channel depends on it
  kAtLower,       ///< on its lower bound, with the cost falling beyond it; held in the linear analysis
  kAtUpper,       ///< the same at the upper bound
  kNoDependence,  ///< no fitted channel changes with it here
};

/// All in the variables of the unit box.
struct Linearization {
  /// Rows of one training block.
  struct Rows {
    int block = 0;
    int first = 0;
    int count = 0;
    double signal = 0;  ///< [1] root mean square of the weighted predicted values
  };

  Vector x;           ///< [n]
  Vector parameters;  ///< [P] at x
  Vector slopes;      ///< [n] dp/dx
  Vector residuals;   ///< [m] weighted; the last rows are priors and ranges
  Matrix jacobian;    ///< [m x n]
  Vector gradient;    ///< [n] of the cost
  double cost = 0;
  std::vector<Rows> blocks;
  int data_rows = 0;                   ///< rows of the blocks; priors follow, then ranges
  std::vector<int> prior_variable;     ///< of the rows of priors
  std::vector<VariableStatus> status;  ///< [n]
  std::vector<int> reported;           ///< variables that are findings, increasing
  std::vector<int> nuisance;           ///< the others, increasing

  [[nodiscard]] const Parameter& parameter(const LeastSquares& problem, int variable) const {
    return problem.setup()
        .parameters[static_cast<std::size_t>(problem.setup().free[static_cast<std::size_t>(variable)])];
  }
};

/// @param x [n] solution within the box. Errors: the problem's own at x.
Result<Linearization> Linearize(const LeastSquares& problem, const Vector& x);

/// Names of the fitted channels, each once, in the order of the layout.
[[nodiscard]] std::vector<std::string> FittedChannels(const LeastSquares& problem);

/// True if no fitted channel changes when the variable is moved to several places of its range and all others
/// stay: then it has no effect over its whole range. Points without a prediction are skipped.
[[nodiscard]] bool IsWithoutEffectEverywhere(const LeastSquares& problem, const Linearization& at,
                                             int variable);

}  // namespace sinew::uncertainty
