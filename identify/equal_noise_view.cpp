#include "identify/equal_noise_view.h"

#include <cmath>
#include <map>

namespace sinew {

EqualNoiseView::EqualNoiseView(const Problem& inner) : ProblemView(inner) {
  struct Channel {
    bool stated = true;           // every fitted trial states its noise level
    double squared_weights = 0;   // sum over the fitted samples, of the inner problem
    double inverse_variance = 0;  // the same sum of 1 / sigma^2
    double samples = 0;
  };
  std::map<std::string, Channel> channels;
  for (const Block& block : layout_) {
    if (block.role != BlockRole::kTrain || block.range) continue;
    Channel& channel = channels[block.channel];
    channel.stated = channel.stated && block.sigma.has_value();
    channel.squared_weights += block.samples() * block.weight * block.weight;
    channel.inverse_variance += block.sigma ? block.samples() / (*block.sigma * *block.sigma) : 0;
    channel.samples += block.samples();
  }
  for (Block& block : layout_) {
    const auto found = channels.find(block.channel);
    if (found == channels.end() || block.range || block.role == BlockRole::kPredicted) continue;
    const Channel& channel = found->second;
    if (!(channel.squared_weights > 0)) continue;
    block.weight = channel.stated && block.sigma
                       ? std::sqrt(channel.squared_weights / channel.inverse_variance) / *block.sigma
                       : std::sqrt(channel.squared_weights / channel.samples);
  }
}

std::string EqualNoiseView::objective() const {
  return "half the sum of squared errors over the noise variance of their channel";
}

}  // namespace sinew
