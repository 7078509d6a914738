// Pattern search over a few positive values, for functions that have no derivatives.
#pragma once

#include <functional>
#include <vector>

#include "base/linear_algebra.h"

namespace sinew::solvers {

/// Positive values [K], moved one at a time by a factor, up or down as long as that is better, until no move
/// is; then by the roots of the factors, kHalvings times. Values that were tried are not tried again.
/// Source: Hooke, Jeeves (1961), J. ACM 8:212.
class PatternSearch {
 public:
  static constexpr int kHalvings = 2;
  /// Whether these values are better than those before; then the search goes on from them.
  using IsBetter = std::function<bool(const Vector& values)>;

  /// @param factors [K, > 1] of the first moves @param stopped ends the search
  PatternSearch(Vector lower, Vector upper, const Vector& factors, IsBetter is_better,
                std::function<bool()> stopped);

  /// @param values where it begins @return where it ends
  Vector From(Vector values);

 private:
  bool Sweep();
  bool Move(Eigen::Index k, double step);
  bool IsNew(const Vector& values);

  Vector lower_;
  Vector upper_;
  Vector first_steps_;  // of the logarithms
  IsBetter is_better_;
  std::function<bool()> stopped_;
  Vector values_;
  Vector steps_;
  std::vector<Vector> tried_;  // logarithms
};

}  // namespace sinew::solvers
