// Likelihood of a noise model for residuals whose fitted part could be anything in the span of the
// regressors.
#pragma once

#include <vector>

#include "identify/noise/lagged_products.h"
#include "identify/noise/noise_model.h"

namespace sinew::noise {

/// Blocks without what the likelihood does not see: regressors of unit length, none that is a combination of
/// others (squared sine below 1e-10), the ordinary least-squares fit taken off the residuals.
struct ReducedBlocks {
  std::vector<LaggedBlock> blocks;  ///< columns count the kept regressors
  int columns = 0;                  ///< kept regressors
  int samples = 0;
};
[[nodiscard]] ReducedBlocks Reduce(const std::vector<NoiseBlock>& blocks);

/// What remains of normal equations when the regressors are fitted.
struct ProfiledOut {
  double power = 0;            ///< sum of squares that is left
  double log_determinant = 0;  ///< of the gram matrix
};
/// A direction that whitening has shrunk below 1e-12 of its columns counts as if it were of that size.
/// @param gram [k x k] lower triangle; overwritten
[[nodiscard]] ProfiledOut ProfileOut(WhitenedNormalEquations& equations);

}  // namespace sinew::noise
