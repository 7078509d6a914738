#include "identify/diagnosis/select/visible_noise.h"

#include "identify/noise/low_frequency_excess.h"

namespace sinew::diagnosis {
namespace {

constexpr double kMoreThanNoise = 1.75;  // deviation of a residual over that of its visible noise

}  // namespace

std::map<std::string, double> NoiseBelowMisfit(const std::vector<noise::NoiseBlock>& blocks) {
  std::map<std::string, std::vector<Vector>> stretches;
  for (const noise::NoiseBlock& block : blocks) {
    if (block.largest_root < 1) continue;
    for (std::size_t s = 0; s < block.stretches.size(); ++s) {
      const auto begin = static_cast<Eigen::Index>(block.stretches[s]);
      const auto end = s + 1 < block.stretches.size() ? static_cast<Eigen::Index>(block.stretches[s + 1])
                                                      : block.residual.size();
      stretches[block.channel].emplace_back(block.residual.segment(begin, end - begin));
    }
  }
  std::map<std::string, double> visible;
  for (const auto& [channel, residual] : stretches) {
    const auto excess = noise::FindLowFrequencyExcess(residual);
    if (excess && excess->ratio() > kMoreThanNoise) visible[channel] = excess->noise;
  }
  return visible;
}

noise::NoiseModel WithVisibleNoise(noise::NoiseModel residual, const std::map<std::string, double>& visible) {
  for (noise::ChannelNoiseModel& channel : residual.channels) {
    const auto found = visible.find(channel.channel);
    if (found == visible.end()) continue;
    channel.coefficients.clear();
    channel.deviation = found->second;
  }
  return residual;
}

}  // namespace sinew::diagnosis
