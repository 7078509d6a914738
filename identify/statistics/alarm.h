// One family-wise level for many correlated tests: the distribution of the smallest p-value under the null
// hypothesis.
#pragma once

#include <cstdint>
#include <vector>

#include "base/linear_algebra.h"

namespace sinew::statistics {

/// A candidate: columns of the whitened, projected design that are tested together.
struct AlarmGroup {
  std::vector<int> columns;  ///< distinct
  bool positive = false;     ///< one column whose effect has a physical sign: one-sided test, t > 0
  double weight = 1;         ///< > 0; multiplies its p-value: its share of the level is 1 / weight
};

/// p-value of one group alone (without its weight) for column scores t that are N(0, correlation) under the
/// null hypothesis: t' pinv(R) t is chi-squared with the rank of R, the group's part of the correlation; a
/// positive single column is one-sided, p = P(Z >= t), and 1 for t <= 0. Eigenvalues of R below 1e-8 of its
/// largest count as zero. A group without columns, or whose columns are all zero, has p = 1.
/// @param correlation [K x K] @param t [K]
[[nodiscard]] double GroupPValue(const Matrix& correlation, const Vector& t, const AlarmGroup& group);

/// Distribution of the smallest weighted p-value over all groups under the null hypothesis, from draws of t ~
/// N(0, R) with a fixed seed (Westfall, Young 1993). R may have any rank. The noise level counts as known
/// (residual degrees of freedom in the hundreds).
class AlarmLevel {
 public:
  /// @param correlation [K x K] positive semidefinite @param draws >= 1
  AlarmLevel(const Matrix& correlation, const std::vector<AlarmGroup>& groups, std::uint64_t seed,
             int draws = 2000);

  /// Probability that any group has a weighted p-value of at most `weighted_p`: (1 + draws with a smallest
  /// one at most that) / (1 + draws), or Bonferroni's bound where it is smaller, which is sharp beyond the
  /// smallest draw.
  [[nodiscard]] double FamilyPValue(double weighted_p) const;
  /// Critical weighted p-value: below it the family-wise p-value is at most `level`.
  /// @param level in (0, 1)
  [[nodiscard]] double Threshold(double level) const;

 private:
  std::vector<double> smallest_;  // [draws] increasing
  double shares_ = 0;             // sum of 1 / weight: Bonferroni's factor
};

}  // namespace sinew::statistics
