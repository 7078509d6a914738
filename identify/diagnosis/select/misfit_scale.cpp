#include "identify/diagnosis/select/misfit_scale.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "identify/noise/difference_noise.h"
#include "identify/noise/input_noise.h"

namespace sinew::diagnosis {
namespace {

constexpr double kLarge = 10;      // deviation of a misfit over that of the noise
constexpr double kLikeStated = 2;  // ... of a residual that may be noise
constexpr double kLikeDifferences = 4;
constexpr double kNoMore = 1.5;       // ... of one that is hardly more than noise
constexpr double kOnlyNoise = 1.1;    // ... of noise alone
constexpr double kLeastShare = 1e-3;  // noise that is not visible, as a share of the signal's deviation
constexpr double kStronglyAutocorrelated = 0.97;  // root of the noise ...
constexpr double kProcessOverInnovation = 5;      // ... and deviation over that of its innovations
// The same limits of a residual that is mostly noise of the inputs, of which each trial is one random walk.
constexpr double kLargeOfInputNoise = 4;
constexpr double kLikeInputNoise = 2;

double Deviation(const Block& block) {
  const Eigen::Map<const Vector> measured(block.measured.data(), block.samples());
  return std::sqrt((measured.array() - measured.mean()).square().mean());
}

}  // namespace

MisfitScale::MisfitScale(const Problem& problem) : problem_(&problem) {
  struct Found {
    std::vector<double> levels;
    bool stated = true;
    std::size_t smooth = 0;  // of the levels
    NoiseUnknown why_none = NoiseUnknown::kFewSamples;
  };
  std::map<std::string, Found> found;
  for (const Block& block : problem.layout()) {
    if (block.role != BlockRole::kTrain || block.measured.empty() || block.range) continue;
    Found& channel = found[block.channel];
    const std::optional<noise::MeasuredNoise> measured =
        block.sigma ? noise::MeasuredNoise{*block.sigma, true} : noise::DifferenceNoise(block);
    channel.stated = channel.stated && block.sigma;
    if (!measured) {
      if (block.noise_memory) channel.why_none = NoiseUnknown::kCorrelated;
      continue;
    }
    const double least = measured->visible ? 0 : kLeastShare * Deviation(block);
    const double level = std::max(measured->deviation, least);
    if (level <= 0) {
      channel.why_none = NoiseUnknown::kConstant;
      continue;
    }
    channel.levels.push_back(block.weight * level);
    if (!measured->visible && measured->deviation < least) ++channel.smooth;
  }
  for (auto& [name, channel] : found) {
    Channel made{name, 0, NoiseSource::kNone, channel.why_none};
    if (!channel.levels.empty()) {
      const auto middle = channel.levels.begin() + static_cast<std::ptrdiff_t>(channel.levels.size() / 2);
      std::nth_element(channel.levels.begin(), middle, channel.levels.end());
      made.noise = *middle;
      made.source = channel.stated ? NoiseSource::kStated : NoiseSource::kDifferences;
      made.unknown = 2 * channel.smooth > channel.levels.size() ? NoiseUnknown::kSmooth : NoiseUnknown::kNo;
    }
    channels_.push_back(std::move(made));
  }
}

const char* ToString(NoiseUnknown why) {
  switch (why) {
    case NoiseUnknown::kNo:
      return "";
    case NoiseUnknown::kFewSamples:
      return "few_samples";
    case NoiseUnknown::kCorrelated:
      return "correlated";
    case NoiseUnknown::kConstant:
      return "constant";
    case NoiseUnknown::kSmooth:
      return "smooth";
  }
  return "?";
}

bool StronglyAutocorrelated(const noise::ChannelNoiseModel& channel) {
  return channel.LargestRoot() > kStronglyAutocorrelated &&
         channel.ProcessDeviation() > kProcessOverInnovation * channel.deviation;
}

const MisfitScale::Channel* MisfitScale::Find(const std::string& channel) const {
  const auto found = std::find_if(channels_.begin(), channels_.end(),
                                  [&](const Channel& one) { return one.name == channel; });
  return found == channels_.end() || found->source == NoiseSource::kNone ? nullptr : &*found;
}

MisfitScale MisfitScale::At(const Refit& refit) const {
  MisfitScale at = *this;
  const LeastSquares fit(*problem_, *refit.setup);
  const auto propagated = noise::PropagateInputNoise(fit, fit.Variables(refit.point));
  if (!propagated) return at;
  for (const noise::PropagatedNoise& one : *propagated) {
    const auto own = std::find_if(at.channels_.begin(), at.channels_.end(),
                                  [&](const Channel& channel) { return channel.name == one.channel; });
    const double carried = refit.holds_input_noise ? one.whole : one.after_fit;
    if (own == at.channels_.end() || !(carried > 0)) continue;
    if (carried > own->noise) {
      if (own->source == NoiseSource::kNone) own->source = NoiseSource::kDifferences;
      own->unknown = NoiseUnknown::kNo;
    }
    own->noise = std::hypot(own->noise, carried);
    own->from_inputs = carried;
    own->residual = one.residual;
  }
  return at;
}

bool MisfitScale::HoldsInputNoise(const std::string& channel) const {
  const Channel* own = Find(channel);
  return own != nullptr && own->holds_input_noise();
}

std::vector<std::string> MisfitScale::LikeInputNoise() const {
  std::vector<std::string> names;
  for (const Channel& channel : channels_) {
    if (channel.holds_input_noise() && channel.residual <= kLikeInputNoise * channel.noise)
      names.push_back(channel.name);
  }
  return names;
}

double MisfitScale::Excess(const noise::ChannelNoiseModel& residual, const Channel& own) {
  return (own.holds_input_noise() ? own.residual : residual.ProcessDeviation()) / own.noise;
}

bool MisfitScale::IsMisfit(const noise::ChannelNoiseModel& residual) const {
  const Channel* own = Find(residual.channel);
  if (own != nullptr && own->holds_input_noise()) return Excess(residual, *own) > kLargeOfInputNoise;
  return StronglyAutocorrelated(residual) || (own != nullptr && Excess(residual, *own) > kLarge);
}

bool MisfitScale::Dominates(const noise::NoiseModel& noise) const {
  return std::any_of(noise.channels.begin(), noise.channels.end(),
                     [&](const auto& residual) { return IsMisfit(residual); });
}

noise::NoiseModel MisfitScale::Floor(noise::NoiseModel residual) const {
  for (noise::ChannelNoiseModel& channel : residual.channels) {
    const Channel* own = Find(channel.channel);
    if (own == nullptr || !(own->holds_input_noise() || IsMisfit(channel))) continue;
    channel.coefficients.clear();
    channel.deviation = own->noise;
  }
  return residual;
}

bool MisfitScale::Resembles(const noise::NoiseModel& noise) const {
  return Within(noise, kLikeStated, kLikeDifferences);
}

bool MisfitScale::IsNoMore(const noise::NoiseModel& noise) const {
  return IsKnown(noise) && Within(noise, kNoMore, kNoMore);
}

bool MisfitScale::IsNoise(const noise::NoiseModel& noise) const {
  return IsKnown(noise) && Within(noise, kOnlyNoise, kOnlyNoise);
}

bool MisfitScale::IsKnown(const noise::NoiseModel& noise) const {
  return std::all_of(noise.channels.begin(), noise.channels.end(), [&](const auto& residual) {
    const Channel* own = Find(residual.channel);
    return own != nullptr && own->unknown == NoiseUnknown::kNo;
  });
}

bool MisfitScale::Within(const noise::NoiseModel& noise, double of_stated, double of_differences) const {
  return std::none_of(noise.channels.begin(), noise.channels.end(), [&](const auto& residual) {
    const Channel* own = Find(residual.channel);
    const bool may_be_slow = own != nullptr && own->holds_input_noise();
    if (!may_be_slow && StronglyAutocorrelated(residual)) return true;
    if (own == nullptr) return false;
    return Excess(residual, *own) > (own->source == NoiseSource::kStated ? of_stated : of_differences);
  });
}

}  // namespace sinew::diagnosis
