// The shape factor: the peak of a muscle's EMG as a function of speed. SCIENCE section 5.
#pragma once

#include <vector>

#include "base/error.h"

namespace sinew {

enum class FactorLaw {
  kRegression,     ///< a straight line by least squares over the measured speeds (the thesis's)
  kInterpolation,  ///< straight lines between the measured speeds; beyond them, the nearest one's factor
};

/// Factor as a function of speed. Never below 0: a line that falls below stays there.
class ShapeFactor {
 public:
  /// @param speeds [n >= 1, rad/s or any unit, no two equal; any order] @param factors [n, finite]
  /// One speed makes a constant. Errors: sizes, none, numbers that are not finite, a speed that comes twice.
  static Result<ShapeFactor> Fit(const std::vector<double>& speeds, const std::vector<double>& factors,
                                 FactorLaw law);

  [[nodiscard]] double At(double speed) const;

  /// Within the measured speeds (to 1e-9 of them).
  [[nodiscard]] bool Covers(double speed) const;

  [[nodiscard]] double slowest() const { return speeds_.front(); }
  [[nodiscard]] double fastest() const { return speeds_.back(); }
  /// Of the regression line, with either law: factor = intercept + slope speed.
  [[nodiscard]] double slope() const { return slope_; }
  [[nodiscard]] double intercept() const { return intercept_; }
  /// Root mean square of the factors about the line, n - 2; 0 for one or two speeds.
  [[nodiscard]] double scatter() const { return scatter_; }

 private:
  ShapeFactor() = default;
  FactorLaw law_ = FactorLaw::kRegression;
  std::vector<double> speeds_;  // increasing
  std::vector<double> factors_;
  double slope_ = 0;
  double intercept_ = 0;
  double scatter_ = 0;
};

}  // namespace sinew
