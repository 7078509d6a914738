// Other predictions of the same measurements, to judge the model's own by: without what was estimated of each
// trial, or without any model.
#pragma once

#include <string>
#include <vector>

#include "identify/fit_quality.h"

namespace sinew {

/// A prediction as a problem proposes it: at other parameters, or as given values.
struct AlternativePrediction {
  std::string name;            ///< after "predicted": "from the recorded motion alone"
  Vector parameters;           ///< [P], or empty: see `values`
  std::vector<Vector> values;  ///< [layout size][predictions]; empty for a block that it does not predict
  std::vector<Vector> half_width{};  ///< as `values`: of its 95 % band [unit]; empty: no band is stated
  /// [layout size][predictions] what is compared; empty, or empty for a block: all of it
  std::vector<std::vector<bool>> compared{};
};

/// Its errors, as FullPrediction has them.
struct AlternativeQuality {
  std::string name;
  std::vector<FitQuality> quality;
  std::vector<FitQuality> pooled;
  std::vector<double> half_width{};  ///< [quality, unit] root mean square of the band's; 0: none stated
  std::vector<double> pooled_half_width{};  ///< [pooled, unit]
};

class Problem;

/// The errors of all that the problem proposes (Problem::Alternatives). One that cannot be predicted is left
/// out. @param parameters [P] of the answer
[[nodiscard]] std::vector<AlternativeQuality> CompareAlternatives(const Problem& problem,
                                                                  const Vector& parameters);

}  // namespace sinew
