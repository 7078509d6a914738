// Factors on residuals that depend on time: windows of a trial, and stretches that are left out of it.
#pragma once

#include <vector>

#include "identify/least_squares.h"

namespace sinew::solvers {

/// Multiplies every residual of the data by a factor of its time, counted as a share of the time between the
/// first and the last sample of its trial. The factors are 1 until they are set.
class TimeFactors final : public RowTransform {
 public:
  explicit TimeFactors(const LeastSquares& fit);

  /// @param factor of a trial and a share in [0, 1] of its time: double(std::size_t, double)
  template <class Factor>
  void Set(const Factor& factor) {
    for (std::size_t block = 0; block < shares_.size(); ++block) {
      factors_[block] = shares_[block].unaryExpr([&](double share) { return factor(trial_[block], share); });
    }
  }
  /// Of a training block: trials are counted in the order of their first one.
  [[nodiscard]] std::size_t TrialOf(std::size_t block) const { return trial_[block]; }
  [[nodiscard]] std::size_t trials() const { return trials_; }
  /// Of every training block [its samples].
  [[nodiscard]] const std::vector<Vector>& shares() const { return shares_; }

  void Apply(int train_block, Eigen::Ref<Matrix> rows) const override;
  void AddTo(Digest& digest) const override;

 private:
  std::size_t trials_ = 0;
  std::vector<std::size_t> trial_;
  std::vector<Vector> shares_;
  std::vector<Vector> factors_;
};

}  // namespace sinew::solvers
