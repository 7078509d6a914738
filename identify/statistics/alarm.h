// One level for everything that could raise an alarm: the smallest p-value of many correlated tests, and what
// it is by chance.
#pragma once

#include <cstdint>
#include <vector>

#include "base/linear_algebra.h"

namespace sinew::statistics {

/// A candidate that could raise an alarm: columns of the whitened, projected design that are judged together.
struct AlarmGroup {
  std::vector<int> columns;  ///< distinct
  bool positive = false;     ///< one column whose effect has a physical sign: only t > 0 counts
  double weight = 1;  ///< > 0; its p-value is multiplied by this: a family's share of the level is 1 / weight
};

/// p-value of one group alone (its weight is not applied) for column scores t that are N(0, correlation) if
/// nothing is wrong: t' pinv(R) t is chi-squared with the rank of R, the group's part of the correlation; a
/// positive single column is one-sided, p = P(Z >= t), and 1 for t <= 0. Eigenvalues of R below 1e-8 of its
/// largest count as zero. A group without columns, or whose columns are all zero, has p = 1.
/// @param correlation [K x K] @param t [K]
[[nodiscard]] double GroupPValue(const Matrix& correlation, const Vector& t, const AlarmGroup& group);

/// Distribution of the smallest weighted p-value over all groups if nothing is wrong, from draws of t ~ N(0,
/// R) with a fixed seed. R may have any rank. The noise level counts as known (residual degrees of freedom in
/// the hundreds).
class AlarmLevel {
 public:
  /// @param correlation [K x K] positive semidefinite @param draws >= 1
  AlarmLevel(const Matrix& correlation, const std::vector<AlarmGroup>& groups, std::uint64_t seed,
             int draws = 2000);

  /// Chance that any group has a weighted p-value of at most `weighted_p`: (1 + draws at most so small) /
  /// (1 + draws), or Bonferroni's bound where it is smaller, which is sharp where no draw reaches.
  [[nodiscard]] double FamilyPValue(double weighted_p) const;
  /// An alarm is a weighted p-value below this: its family p-value is then at most `level`.
  /// @param level in (0, 1)
  [[nodiscard]] double Threshold(double level) const;

 private:
  std::vector<double> smallest_;  // [draws] increasing
  double shares_ = 0;             // sum of 1 / weight: Bonferroni's factor
};

}  // namespace sinew::statistics
