// Errors of a predicted curve: the two measures of the thesis. SCIENCE section 5.
#pragma once

#include <cstddef>
#include <vector>

#include "base/error.h"

namespace sinew {

struct PredictionError {
  double rmse = 0;  ///< root mean square of the differences [unit of the curves]
  /// Square of Pearson's correlation (product moment, section 6.4.3): a measure of the similarity of shapes,
  /// not of sizes, and not the share of variance explained [0..1]. NaN if a curve is constant.
  double r_squared = 0;
};

/// @param predicted [N >= 2] @param measured [N]. Errors: sizes, fewer than 2, values that are not finite.
Result<PredictionError> ComparePrediction(const std::vector<double>& predicted,
                                          const std::vector<double>& measured);

/// Mean and standard deviation (n - 1) over cycles, as the thesis's tables have them.
struct ErrorSummary {
  std::size_t count = 0;
  double rmse = 0;
  double rmse_deviation = 0;        ///< NaN for fewer than two
  std::size_t r_squared_count = 0;  ///< those whose R2 is a number
  double r_squared = 0;
  double r_squared_deviation = 0;
};

/// All NaN if there are none.
[[nodiscard]] ErrorSummary Summarise(const std::vector<PredictionError>& errors);

}  // namespace sinew
