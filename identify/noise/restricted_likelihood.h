// Restricted likelihood of a noise model: that of the residuals' components orthogonal to the regressors.
#pragma once

#include <vector>

#include "identify/noise/lagged_products.h"
#include "identify/noise/noise_model.h"

namespace sinew::noise {

/// Blocks in the form that the likelihood needs: regressors of unit length without linear combinations of
/// others (squared sine below 1e-10), and residuals of the ordinary least-squares fit.
struct ReducedBlocks {
  std::vector<LaggedBlock> blocks;  ///< their `columns` index the kept regressors
  int columns = 0;                  ///< kept regressors
  int samples = 0;
};
[[nodiscard]] ReducedBlocks Reduce(const std::vector<NoiseBlock>& blocks);

/// Residual sum of squares and determinant of normal equations, with the regressors fitted.
struct ProfiledOut {
  double power = 0;            ///< residual sum of squares
  double log_determinant = 0;  ///< of the gram matrix
};
/// Profiles out the regressors. A direction whose squared length after whitening is below 1e-12 of its
/// columns is treated as if it had that length.
[[nodiscard]] ProfiledOut ProfileOut(WhitenedNormalEquations& equations);

}  // namespace sinew::noise
