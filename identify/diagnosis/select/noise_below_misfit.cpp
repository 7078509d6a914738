#include "identify/diagnosis/select/noise_below_misfit.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "identify/noise/low_frequency_excess.h"

namespace sinew::diagnosis {
namespace {

constexpr double kMoreThanNoise = 1.75;  // deviation of a residual over that of its visible noise
constexpr double kMoreThanStated = 2;    // ... over the level that the data state, which may be rough
constexpr double kSmooth = 0.3;          // least autocorrelation of neighbours of a smooth residual ...
constexpr double kStandardErrors = 3;    // ... and that over its standard error if the residual were white

// The residual of one channel, in stretches without gaps.
struct ChannelResidual {
  std::vector<Vector> stretches;
  std::vector<std::optional<double>> stated;  // level of each, stated by the data
};

// The level that the data state, if the residual is smooth and more than twice of it.
std::optional<double> StatedNoiseBelow(const ChannelResidual& channel) {
  double level = 0;  // sums of squares
  double all = 0;
  double differences = 0;
  double pairs = 0;
  Eigen::Index samples = 0;
  Eigen::Index neighbours = 0;
  for (std::size_t s = 0; s < channel.stretches.size(); ++s) {
    const Vector& stretch = channel.stretches[s];
    if (!channel.stated[s]) return std::nullopt;
    const Eigen::Index last = stretch.size() - 1;
    level += static_cast<double>(stretch.size()) * *channel.stated[s] * *channel.stated[s];
    all += stretch.squaredNorm();
    differences += (stretch.tail(last) - stretch.head(last)).squaredNorm();
    pairs += stretch.tail(last).squaredNorm() + stretch.head(last).squaredNorm();
    samples += stretch.size();
    neighbours += last;
  }
  if (neighbours == 0 || all <= kMoreThanStated * kMoreThanStated * level) return std::nullopt;
  const double autocorrelation = 1 - differences / pairs;
  if (autocorrelation < std::max(kSmooth, kStandardErrors / std::sqrt(static_cast<double>(neighbours))))
    return std::nullopt;
  return std::sqrt(level / static_cast<double>(samples));
}

}  // namespace

std::map<std::string, double> NoiseBelowMisfit(const std::vector<noise::NoiseBlock>& blocks) {
  std::map<std::string, ChannelResidual> channels;
  for (const noise::NoiseBlock& block : blocks) {
    if (block.largest_root < 1) continue;
    ChannelResidual& channel = channels[block.channel];
    for (std::size_t s = 0; s < block.stretches.size(); ++s) {
      const auto begin = static_cast<Eigen::Index>(block.stretches[s]);
      const auto end = s + 1 < block.stretches.size() ? static_cast<Eigen::Index>(block.stretches[s + 1])
                                                      : block.residual.size();
      if (end == begin) continue;
      channel.stretches.emplace_back(block.residual.segment(begin, end - begin));
      channel.stated.push_back(block.stated);
    }
  }
  std::map<std::string, double> noise;
  for (const auto& [name, residual] : channels) {
    const auto excess = noise::FindLowFrequencyExcess(residual.stretches);
    if (const auto stated = StatedNoiseBelow(residual)) {
      noise[name] = *stated;
    } else if (excess && excess->ratio() > kMoreThanNoise) {
      noise[name] = excess->noise;
    }
  }
  return noise;
}

noise::NoiseModel WithNoiseBelowMisfit(noise::NoiseModel residual,
                                       const std::map<std::string, double>& visible) {
  for (noise::ChannelNoiseModel& channel : residual.channels) {
    const auto found = visible.find(channel.channel);
    if (found == visible.end()) continue;
    channel.coefficients.clear();
    channel.deviation = found->second;
  }
  return residual;
}

}  // namespace sinew::diagnosis
