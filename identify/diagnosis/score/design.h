// A fit made linear for the diagnosis: residuals, what the fitted parameters can do to them, and what every
// candidate would do.
#pragma once

#include <vector>

#include "base/error.h"
#include "identify/diagnosis/score/candidate.h"
#include "identify/least_squares.h"
#include "identify/noise/noise_model.h"

namespace sinew::diagnosis {

/// Length of a whitened signature that a test for it alone notices with 95 % at the 5 % level: 1.960 + 1.645.
inline constexpr double kDetectableLength = 3.605;

/// One column of a design: what one parameter of a candidate adds to the weighted residuals, per unit.
struct DesignColumn {
  int candidate = 0;
  int probe = 0;
  int parameter = 0;
  bool positive = false;  ///< the null is its lower bound: only one sign makes sense
  bool negative = false;  ///< the null is its upper bound
};

struct Design {
  Vector x;                           ///< [n] variables of the fit
  Vector residual;                    ///< [m] weighted, rows of the training blocks
  Matrix base;                        ///< [m x n] derivatives for the variables of the fit
  Matrix candidates;                  ///< [m x K] derivatives or secants of the candidates' parameters
  std::vector<DesignColumn> columns;  ///< [K]
};

/// Residuals and the fitted parameters' columns alone, as the noise model wants them.
/// Errors: the problem's own at x.
Result<std::vector<noise::NoiseBlock>> NoiseBlocks(const LeastSquares& fit, const Vector& x);

/// Candidates that the fit has released already get no columns.
/// @param whitening says how long a secant should be: its trace about as large as what a test would just
/// detect. Candidates whose prediction fails are left out of the columns. Errors: the problem's own at x.
Result<Design> MakeDesign(const LeastSquares& fit, const Vector& x, const std::vector<Candidate>& candidates,
                          const noise::Whitening& whitening);

}  // namespace sinew::diagnosis
