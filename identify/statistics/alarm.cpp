#include "identify/statistics/alarm.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "base/assert.h"
#include "base/decompositions.h"
#include "base/random.h"
#include "identify/statistics/distributions.h"

namespace sinew::statistics {
namespace {

constexpr double kSingular = 1e-8;  // eigenvalue, relative to the largest

/// A matrix root of `symmetric` or of its pseudo-inverse, without the directions whose eigenvalue counts as
/// zero.
/// @return [rank x n], root' * root
Matrix Root(const Matrix& symmetric, bool inverse) {
  if (symmetric.size() == 0) return symmetric;
  const Eigen::SelfAdjointEigenSolver<Matrix> eigen(symmetric);
  const Vector& values = eigen.eigenvalues();
  const double smallest = kSingular * std::max(values.maxCoeff(), 0.0);
  const Eigen::Index rank = (values.array() > smallest).count();
  Matrix root = eigen.eigenvectors().rightCols(rank).transpose();  // eigenvalues increase
  for (Eigen::Index i = 0; i < rank; ++i) {
    const double scale = std::sqrt(values[values.size() - rank + i]);
    root.row(i) *= inverse ? 1 / scale : scale;
  }
  return root;
}

/// Computes the statistic of a group from its scores.
class Judge {
 public:
  Judge(const Matrix& correlation, const AlarmGroup& group) : group_(group) {
    const auto n = static_cast<Eigen::Index>(group.columns.size());
    SINEW_ASSERT(n == 1 || !group.positive, "only a single column can have a sign");
    Matrix part(n, n);
    for (Eigen::Index i = 0; i < n; ++i) {
      for (Eigen::Index j = 0; j < n; ++j) {
        part(i, j) = correlation(group.columns[static_cast<std::size_t>(i)],
                                 group.columns[static_cast<std::size_t>(j)]);
      }
    }
    root_ = Root(part, true);
    scores_.resize(n);
    rotated_.resize(root_.rows());
  }

  [[nodiscard]] int rank() const { return static_cast<int>(root_.rows()); }

  /// Chi-squared with rank() degrees of freedom; 0 for a one-sided group with the wrong sign.
  template <class Scores>
  double Statistic(const Scores& t) {
    if (scores_.size() == 1) {
      const double score = rank() == 0 ? 0 : t[group_.columns.front()] * std::abs(root_(0, 0));
      return group_.positive && score < 0 ? 0 : score * score;
    }
    for (std::size_t i = 0; i < group_.columns.size(); ++i) {
      scores_[static_cast<Eigen::Index>(i)] = t[group_.columns[i]];
    }
    rotated_.noalias() = root_ * scores_;
    return rotated_.squaredNorm();
  }

 private:
  const AlarmGroup& group_;
  Matrix root_;
  Vector scores_;
  Vector rotated_;
};

double PValue(double statistic, int rank, bool positive) {
  if (rank == 0) return 1;
  if (!positive) return ChiSquaredUpperTail(statistic, rank);
  return statistic > 0 ? 0.5 * ChiSquaredUpperTail(statistic, 1) : 1;
}

}  // namespace

double GroupPValue(const Matrix& correlation, const Vector& t, const AlarmGroup& group) {
  Judge judge(correlation, group);
  return PValue(judge.Statistic(t), judge.rank(), group.positive);
}

AlarmLevel::AlarmLevel(const Matrix& correlation, const std::vector<AlarmGroup>& groups, std::uint64_t seed,
                       int draws) {
  // Among groups of the same rank, sign and weight the largest statistic has the smallest p-value: one
  // evaluation of the tail per kind instead of per group.
  using Kind = std::tuple<int, bool, double>;
  std::map<Kind, std::vector<Judge>> kinds;
  for (const AlarmGroup& group : groups) {
    Judge judge(correlation, group);
    if (judge.rank() == 0) continue;
    shares_ += 1 / group.weight;
    kinds[{judge.rank(), group.positive, group.weight}].push_back(std::move(judge));
  }

  const Matrix root = Root(correlation, false);
  Random random(seed);
  Matrix normal(root.rows(), draws);
  for (Eigen::Index i = 0; i < normal.size(); ++i) normal.data()[i] = random.Normal();
  const Matrix scores = root.transpose() * normal;
  smallest_.assign(static_cast<std::size_t>(draws), 1);
  for (auto& [kind, judges] : kinds) {
    const auto& [rank, positive, weight] = kind;
    for (Eigen::Index d = 0; d < draws; ++d) {
      double largest = 0;
      const auto t = scores.col(d);
      for (Judge& judge : judges) largest = std::max(largest, judge.Statistic(t));
      double& smallest = smallest_[static_cast<std::size_t>(d)];
      smallest = std::min(smallest, weight * PValue(largest, rank, positive));
    }
  }
  std::sort(smallest_.begin(), smallest_.end());
}

double AlarmLevel::FamilyPValue(double weighted_p) const {
  if (shares_ == 0) return 1;  // no group has a test
  const auto above = std::upper_bound(smallest_.begin(), smallest_.end(), weighted_p);
  const auto reached = static_cast<double>(above - smallest_.begin());
  const double drawn = (1 + reached) / (1 + static_cast<double>(smallest_.size()));
  return std::min(drawn, weighted_p * shares_);
}

double AlarmLevel::Threshold(double level) const {
  const double bonferroni = shares_ > 0 ? std::min(1.0, level / shares_) : 1;
  const double allowed = std::floor(level * (1 + static_cast<double>(smallest_.size()))) - 1;
  if (allowed < 0) return bonferroni;
  const auto index = std::min(static_cast<std::size_t>(allowed), smallest_.size() - 1);
  return std::max(bonferroni, smallest_[index]);
}

}  // namespace sinew::statistics
