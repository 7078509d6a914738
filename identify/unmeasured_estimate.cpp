#include "identify/unmeasured_estimate.h"

#include <cmath>

namespace sinew {

void TakeOver(const UnmeasuredEstimate& estimate, std::vector<Vector>& values) {
  for (std::size_t b = 0; b < values.size(); ++b) {
    if (estimate.values[b].size() > 0) values[b] = estimate.values[b];
  }
}

std::vector<UnmeasuredChannel> Describe(const Layout& layout, const UnmeasuredEstimate& estimate) {
  std::vector<UnmeasuredChannel> channels;
  for (std::size_t b = 0; b < layout.size(); ++b) {
    const Vector& half_width = estimate.half_width[b];
    if (half_width.size() == 0) continue;
    const Block& block = layout[b];
    UnmeasuredChannel channel{block.trial,
                              block.channel,
                              block.quantity,
                              block.unit,
                              estimate.from[b],
                              estimate.values[b].minCoeff(),
                              estimate.values[b].maxCoeff(),
                              half_width,
                              0};
    channel.mean_half_width = std::sqrt(half_width.squaredNorm() / static_cast<double>(half_width.size()));
    channels.push_back(std::move(channel));
  }
  return channels;
}

}  // namespace sinew
