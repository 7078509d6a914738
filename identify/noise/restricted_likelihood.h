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

}  // namespace sinew::noise
