// Trials without a measurement of the fitted channels, where something else tells of their nuisance values.
#pragma once

#include <string>
#include <vector>

#include "base/linear_algebra.h"
#include "identify/layout.h"

namespace sinew {

/// What a problem says of such trials (Problem::EstimateUnmeasured): a step without a force plate, from the
/// motion of the whole body.
struct UnmeasuredEstimate {
  Vector parameters;               ///< [P] with the nuisance values of these trials
  std::vector<Vector> values;      ///< [layout size][predictions] of these trials; empty for all others
  std::vector<Vector> half_width;  ///< as `values`: of the 95 % band [unit]
  std::vector<std::string> from;   ///< [layout size] "the motion alone"; empty for all others
};

/// Takes the values over into a prediction. @param values [layout size][predictions]
void TakeOver(const UnmeasuredEstimate& estimate, std::vector<Vector>& values);

/// One channel of such a trial.
struct UnmeasuredChannel {
  std::string trial;
  std::string channel;
  std::string quantity;
  std::string unit;
  std::string from;  ///< see UnmeasuredEstimate
  double lowest = 0;
  double highest = 0;
  Vector half_width;           ///< [predictions] of the 95 % band
  double mean_half_width = 0;  ///< its root mean square [unit]
};

/// The channels that have values.
[[nodiscard]] std::vector<UnmeasuredChannel> Describe(const Layout& layout,
                                                      const UnmeasuredEstimate& estimate);

}  // namespace sinew
