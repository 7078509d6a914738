#include "identify/uncertainty/noise.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sinew::uncertainty {
namespace {

// A fit without error (data made by the model itself) still has rounding errors of about this size.
constexpr double kExactFit = 1e-10;
// Keeps 1 / sigma finite for a channel that is zero throughout.
constexpr double kSmallestSigma = 1e-100;
// Below one degree of freedom an estimated level is a number without meaning.
constexpr double kMinDegrees = 0.999;

/// Sums over the training blocks of one channel.
struct ChannelSums {
  double residual = 0;  ///< sum of squares [unit^2], all blocks
  double signal = 0;
  double samples = 0;
  double estimated = 0;  ///< sum of squares of the blocks without sigma
  double degrees = 0;    ///< and their samples less leverage
  double pairs = 0;      ///< sum of r(i) r(i+1)
};

std::size_t ChannelIndex(std::vector<ChannelNoise>& channels, const Block& block) {
  const auto found = std::find_if(channels.begin(), channels.end(),
                                  [&](const ChannelNoise& c) { return c.channel == block.channel; });
  if (found != channels.end()) return static_cast<std::size_t>(found - channels.begin());
  ChannelNoise channel;
  channel.channel = block.channel;
  channel.unit = block.unit;
  channel.known = true;
  channels.push_back(channel);
  return channels.size() - 1;
}

}  // namespace

const ChannelNoise* Noise::Find(const std::string& channel) const {
  const auto found = std::find_if(channels.begin(), channels.end(),
                                  [&](const ChannelNoise& c) { return c.channel == channel; });
  return found == channels.end() ? nullptr : &*found;
}

Result<Noise> EstimateNoise(const LeastSquares& problem, const Linearization& at, const Vector& leverage) {
  const Layout& layout = problem.problem().layout();
  Noise noise;
  std::vector<std::size_t> channel_of;
  std::vector<ChannelSums> sums;
  double pooled = 0;  // weighted, over the blocks without sigma
  double pooled_degrees = 0;
  for (const Linearization::Rows& rows : at.blocks) {
    const Block& block = layout[static_cast<std::size_t>(rows.block)];
    const std::size_t c = ChannelIndex(noise.channels, block);
    channel_of.push_back(c);
    sums.resize(noise.channels.size());
    const Vector residual = at.residuals.segment(rows.first, rows.count) / block.weight;
    const double degrees = rows.count - leverage.segment(rows.first, rows.count).sum();
    ChannelSums& sum = sums[c];
    sum.residual += residual.squaredNorm();
    sum.signal += std::pow(rows.signal / block.weight, 2) * rows.count;
    sum.samples += rows.count;
    sum.pairs += residual.head(rows.count - 1).dot(residual.tail(rows.count - 1));
    if (block.sigma) {
      noise.channels[c].sigma = std::max(noise.channels[c].sigma, *block.sigma);
      continue;
    }
    noise.channels[c].known = false;
    sum.estimated += residual.squaredNorm();
    sum.degrees += degrees;
    pooled += at.residuals.segment(rows.first, rows.count).squaredNorm();
    pooled_degrees += degrees;
  }

  const bool any_estimated =
      std::any_of(noise.channels.begin(), noise.channels.end(), [](const auto& c) { return !c.known; });
  if (any_estimated && pooled_degrees < kMinDegrees) {
    return Fail(
        "{} residuals cannot tell the noise level besides {} fitted values: state sigma or add samples",
        at.data_rows, problem.variables());
  }
  noise.degrees_of_freedom = any_estimated ? pooled_degrees : std::numeric_limits<double>::infinity();
  const double all_degrees = at.data_rows - leverage.head(at.data_rows).sum();
  noise.residual_scale =
      std::sqrt(at.residuals.head(at.data_rows).squaredNorm() / std::max(all_degrees, 1.0));

  std::vector<bool> from_all(sums.size(), false);
  for (std::size_t c = 0; c < sums.size(); ++c) {
    const double signal = std::sqrt(sums[c].signal / sums[c].samples);
    const double rms = std::sqrt(sums[c].residual / sums[c].samples);
    ChannelNoise& channel = noise.channels[c];
    channel.relative = signal > 0 ? rms / signal : 1;
    channel.correlation = sums[c].residual > 0 ? sums[c].pairs / sums[c].residual : 0;
    if (channel.known) continue;
    from_all[c] = sums[c].degrees < kMinDegrees;
    if (!from_all[c]) channel.sigma = std::sqrt(sums[c].estimated / sums[c].degrees);
    channel.sigma = std::max({channel.sigma, kExactFit * signal, kSmallestSigma});
  }

  noise.deviation = Vector::Ones(at.residuals.size());
  for (std::size_t b = 0; b < at.blocks.size(); ++b) {
    const Linearization::Rows& rows = at.blocks[b];
    const Block& block = layout[static_cast<std::size_t>(rows.block)];
    ChannelNoise& channel = noise.channels[channel_of[b]];
    if (from_all[channel_of[b]] && !block.sigma) {
      channel.sigma = std::max(channel.sigma, std::sqrt(pooled / pooled_degrees) / block.weight);
    }
    noise.deviation.segment(rows.first, rows.count)
        .setConstant(block.weight * block.sigma.value_or(channel.sigma));
  }
  return noise;
}

}  // namespace sinew::uncertainty
