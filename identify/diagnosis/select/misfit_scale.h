// Is a misfit large against the noise of the measurement? On a scale that no model takes part in, so that the
// answer does not depend on the sampling rate, the number of trials, or what a noise model can absorb.
#pragma once

#include <string>
#include <vector>

#include "identify/noise/noise_model.h"
#include "identify/problem.h"

namespace sinew::diagnosis {

/// What the noise level of a channel was taken from.
enum class NoiseSource {
  kStated,       ///< the data state it
  kDifferences,  ///< DifferenceNoise of the measured signal
  kNone          ///< neither, see NoiseUnknown
};

/// Why the noise of a channel cannot be had from its measurement.
enum class NoiseUnknown {
  kNo,          ///< it can
  kFewSamples,  ///< no trial has 22 samples without a gap
  kCorrelated,  ///< its noise is known to be correlated, as that of an envelope: differences do not show it
  kConstant,    ///< it does not change
  kSmooth  ///< differences do not show any, and leave less than a thousandth of what it varies by, which is
           ///< taken instead: it is filtered, interpolated or computed
};

/// "", "few_samples", "correlated", "constant", "smooth".
[[nodiscard]] const char* ToString(NoiseUnknown why);

class MisfitScale {
 public:
  struct Channel {
    std::string name;
    double noise = 0;  ///< [unit of the weighted residual] median over the training blocks
    NoiseSource source = NoiseSource::kNone;
    NoiseUnknown unknown = NoiseUnknown::kNo;
  };

  /// Of the training blocks of a problem.
  explicit MisfitScale(const Problem& problem);

  [[nodiscard]] const std::vector<Channel>& channels() const { return channels_; }

  /// True if the residual of some channel is not noise: its deviation is more than ten times the noise level,
  /// or it is strongly autocorrelated with a deviation far above that of its innovations, which no
  /// instrument's noise is. @param noise of that residual
  [[nodiscard]] bool Dominates(const noise::NoiseModel& noise) const;

  /// True if no residual has a deviation of more than twice the stated noise level, or four times the level
  /// from differences, which is a lower limit, and none is strongly autocorrelated.
  [[nodiscard]] bool Resembles(const noise::NoiseModel& noise) const;

  /// True if the noise of every channel is stated or visible, and no residual has more than 1.5 times its
  /// level: no model leaves clearly less.
  [[nodiscard]] bool IsNoMore(const noise::NoiseModel& noise) const;

  /// The same with 1.1 times its level: what structure may hide there is less than half of the noise.
  [[nodiscard]] bool IsNoise(const noise::NoiseModel& noise) const;

  /// The noise of the measurement: that of a residual, but white with the level of this scale where the
  /// residual is a misfit.
  [[nodiscard]] noise::NoiseModel Floor(noise::NoiseModel residual) const;

 private:
  [[nodiscard]] const Channel* Find(const std::string& channel) const;
  [[nodiscard]] bool IsKnown(const noise::NoiseModel& noise) const;
  /// No deviation above so many levels, and none strongly autocorrelated.
  [[nodiscard]] bool Within(const noise::NoiseModel& noise, double of_stated, double of_differences) const;
  [[nodiscard]] bool IsMisfit(const noise::ChannelNoiseModel& residual) const;

  std::vector<Channel> channels_;
};

/// The second of these conditions alone.
[[nodiscard]] bool StronglyAutocorrelated(const noise::ChannelNoiseModel& channel);

}  // namespace sinew::diagnosis
