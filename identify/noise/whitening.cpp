#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "base/assert.h"
#include "base/median.h"
#include "identify/noise/noise_model.h"

namespace sinew::noise {
namespace {

// In median intervals. A servo read over a serial bus is sampled at 0.95 to 1.9 of them without missing
// samples; where two samples in a row are missing it is 3.
constexpr double kGap = 2.5;

std::vector<double> Intervals(const Block& block) {
  std::vector<double> intervals;
  for (std::size_t i = 1; i < block.sample.size(); ++i) {
    intervals.push_back(block.prediction_time[static_cast<std::size_t>(block.sample[i])] -
                        block.prediction_time[static_cast<std::size_t>(block.sample[i - 1])]);
  }
  return intervals;
}

}  // namespace

Whitening::Whitening(NoiseModel model, std::vector<std::vector<int>> stretches)
    : model_(std::move(model)), stretches_(std::move(stretches)) {
  SINEW_ASSERT(model_.channel_of.size() == stretches_.size(), "one list of stretches per training block");
  for (const ChannelNoiseModel& channel : model_.channels) {
    filters_.emplace_back(PartialFromCoefficients(channel.coefficients));
  }
}

void Whitening::Apply(int train_block, Eigen::Ref<Matrix> rows) const {
  const auto b = static_cast<std::size_t>(train_block);
  const auto channel = static_cast<std::size_t>(model_.channel_of[b]);
  const std::vector<int>& starts = stretches_[b];
  for (Eigen::Index c = 0; c < rows.cols(); ++c) {
    for (std::size_t s = 0; s < starts.size(); ++s) {
      const Eigen::Index end = s + 1 < starts.size() ? starts[s + 1] : rows.rows();
      filters_[channel].Apply(rows.col(c).data() + starts[s], end - starts[s]);
    }
  }
  rows /= model_.channels[channel].deviation;
}

void Whitening::AddTo(Digest& digest) const {
  for (const ChannelNoiseModel& channel : model_.channels) {
    digest.Add(channel.coefficients.data(), channel.coefficients.size());
    digest.Add(channel.deviation);
  }
  for (std::size_t b = 0; b < stretches_.size(); ++b) {
    digest.Add(static_cast<std::uint64_t>(model_.channel_of[b]));
    digest.Add(static_cast<std::uint64_t>(stretches_[b].size()));
    for (const int start : stretches_[b]) digest.Add(static_cast<std::uint64_t>(start));
  }
}

std::vector<int> Stretches(const Block& block) {
  const std::vector<double> intervals = Intervals(block);
  std::vector<int> starts = {0};
  if (intervals.empty()) return starts;
  const double longest = kGap * UpperMedian(intervals);
  for (std::size_t i = 0; i < intervals.size(); ++i) {
    if (intervals[i] > longest) starts.push_back(static_cast<int>(i) + 1);
  }
  return starts;
}

double LargestRoot(const Block& block) {
  const std::vector<double> intervals = Intervals(block);
  if (!block.noise_memory || intervals.empty()) return 1;
  return std::exp(-UpperMedian(intervals) / *block.noise_memory);
}

}  // namespace sinew::noise
