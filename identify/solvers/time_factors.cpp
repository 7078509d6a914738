#include "identify/solvers/time_factors.h"

#include <algorithm>
#include <string>

#include "base/constants.h"
#include "base/digest.h"

namespace sinew::solvers {

TimeFactors::TimeFactors(const LeastSquares& fit) {
  std::vector<std::string> names;
  std::vector<double> first;
  std::vector<double> last;
  for (const LeastSquares::TrainBlock& train : fit.train_blocks()) {
    const Block& block = fit.problem().layout()[static_cast<std::size_t>(train.block)];
    const auto trial =
        static_cast<std::size_t>(std::find(names.begin(), names.end(), block.trial) - names.begin());
    if (trial == names.size()) {
      names.push_back(block.trial);
      first.push_back(kInfinity);
      last.push_back(-kInfinity);
    }
    Vector times(static_cast<Eigen::Index>(block.sample.size()));
    for (Eigen::Index i = 0; i < times.size(); ++i) {
      const int sample = block.sample[static_cast<std::size_t>(i)];
      times[i] = block.prediction_time[static_cast<std::size_t>(sample)];
      first[trial] = std::min(first[trial], times[i]);
      last[trial] = std::max(last[trial], times[i]);
    }
    trial_.push_back(trial);
    shares_.push_back(std::move(times));
  }
  trials_ = names.size();
  constexpr double kSmallestDuration = 1e-9;  // [s]
  for (std::size_t block = 0; block < shares_.size(); ++block) {
    const std::size_t trial = trial_[block];
    Vector& shares = shares_[block];
    shares = (shares.array() - first[trial]) / std::max(last[trial] - first[trial], kSmallestDuration);
    factors_.push_back(Vector::Ones(shares.size()));
  }
}

void TimeFactors::Apply(int train_block, Eigen::Ref<Matrix> rows) const {
  rows.array().colwise() *= factors_[static_cast<std::size_t>(train_block)].array();
}

void TimeFactors::AddTo(Digest& digest) const {
  for (const Vector& factor : factors_) digest.Add(factor.data(), static_cast<std::size_t>(factor.size()));
}

}  // namespace sinew::solvers
