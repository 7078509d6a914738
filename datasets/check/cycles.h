// Cycles of a periodic trial: strides, strokes, swings.
#pragma once

#include <vector>

#include "datasets/check/signals.h"

namespace sinew {

struct Cycles {
  double period = 0;           ///< [s] median
  std::vector<double> starts;  ///< [K + 1, s] cycle k is from starts[k] to starts[k + 1]

  [[nodiscard]] int count() const { return starts.empty() ? 0 : static_cast<int>(starts.size()) - 1; }
};

/// The cycles of a trial; none, if it has no six of them. The period is that of the autocorrelation, of all
/// channels together; the starts are where the most regular channel resembles its own median cycle best, so
/// that a minority of spoilt cycles moves neither. Between starts that are several periods apart, because
/// that channel is spoilt there, cycles of equal length are assumed.
/// @param signals of one trial
[[nodiscard]] Cycles FindCycles(const std::vector<const Signal*>& signals);

/// Linear interpolation; NaN outside of the record, in and next to gaps.
[[nodiscard]] double ValueAt(const std::vector<double>& time, const std::vector<double>& values, double t);

}  // namespace sinew
