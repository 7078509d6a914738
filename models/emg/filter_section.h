// Recursive filters as a cascade of second-order sections: one pass as in real time, and two passes without
// lag.
#pragma once

#include <cstddef>
#include <vector>

#include "base/error.h"

namespace sinew {

/// y_k = b0 x_k + b1 x_{k-1} + b2 x_{k-2} - a1 y_{k-1} - a2 y_{k-2}. A section of first order has b2 = a2 =
/// 0.
struct FilterSection {
  double b0 = 1;
  double b1 = 0;
  double b2 = 0;
  double a1 = 0;
  double a2 = 0;
};

/// One after the other; each is stable (|a2| < 1, |a1| < 1 + a2).
using FilterSections = std::vector<FilterSection>;

/// One pass, sample by sample, as a real-time program filters (CEINMS-RT does with two such sections). Its
/// output lags behind.
class CausalFilter {
 public:
  /// Starts from rest: as after a long time of zeros.
  explicit CausalFilter(const FilterSections& sections);

  /// As after a long time of this value.
  void Settle(double value);

  double Next(double value) {
    for (Stage& stage : stages_) {
      const double out = stage.section.b0 * value + stage.first;
      stage.first = stage.section.b1 * value - stage.section.a1 * out + stage.second;
      stage.second = stage.section.b2 * value - stage.section.a2 * out;
      value = out;
    }
    return value;
  }

 private:
  // Transposed direct form II, the form that loses least to rounding at low cut-offs.
  struct Stage {
    FilterSection section;
    double first = 0;
    double second = 0;
  };
  std::vector<Stage> stages_;
};

/// Samples that FilterZeroLag adds at each end, three times the number of coefficients; it needs more samples
/// than that.
[[nodiscard]] std::size_t ZeroLagPadding(const FilterSections& sections);

/// Forward, then backward: no lag, the amplitude response squared. A Butterworth filter then halves the
/// amplitude at its cut-off (-6 dB).
///
/// The signal is first continued at both ends by its mirror image through the end point, 2 x_0 - x_k, and
/// each pass starts settled at its first value. This is scipy.signal.sosfiltfilt with its defaults
/// (Gustafsson, F. 1996, Determining the initial states in forward-backward filtering, IEEE T. Signal
/// Process. 44, 988; "pad" there). The difference to scipy is rounding: below 1e-10 of the signal's range for
/// cut-offs above 1e-3 of the sampling rate.
///
/// @param values [N > ZeroLagPadding(sections), any unit, finite]
/// @return [N, unit of values]. Errors: too few samples; a value that is not finite (states the first).
Result<std::vector<double>> FilterZeroLag(const FilterSections& sections, const std::vector<double>& values);

}  // namespace sinew
