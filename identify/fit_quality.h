// How well a model predicts each channel of each trial.
#pragma once

#include <string>
#include <vector>

#include "base/error.h"
#include "identify/problem.h"

namespace sinew {

struct FitQuality {
  std::string trial;  ///< empty: over all trials of the role
  BlockRole role = BlockRole::kTrain;
  std::string channel;
  std::string unit;
  double rmse = 0;  ///< [unit]
  double r2 =
      0;  ///< 1 - sum of squared errors / sum of squared deviations from the mean; NaN if it does not vary
  int n = 0;       ///< samples compared
  double mae = 0;  ///< mean absolute error [unit]
};

/// A prediction of every channel, measured or not, and its errors.
struct FullPrediction {
  std::vector<Vector> values;       ///< [layout size][predictions]
  std::vector<FitQuality> quality;  ///< of every block with measured samples, in the order of the layout
  std::vector<FitQuality>
      pooled;  ///< the same per role and quantity (channel without the plate's name) over all trials
};

/// Predicts every block and compares it with its measurement. Errors: those of Problem::Predict.
Result<FullPrediction> PredictAll(const Problem& problem, const Vector& parameters);

/// Recomputes `full.quality` and `full.pooled` from `full.values`.
void Assess(const Layout& layout, FullPrediction& full);

}  // namespace sinew
