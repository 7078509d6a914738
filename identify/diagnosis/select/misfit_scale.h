// Is a misfit large against the noise of the measurement? On a scale that no model takes part in, so that the
// answer does not depend on the sampling rate, the number of trials, or what a noise model can absorb.
#pragma once

#include <string>
#include <vector>

#include "identify/diagnosis/fit/refit.h"
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
    double from_inputs = 0;  ///< [same unit] a part of `noise`: noise of recorded inputs, see At
    double residual = 0;     ///< [same unit] root mean square of the fit's residual, if from_inputs > 0

    /// Whether noise of the inputs is so large a part that the residual may look like a random walk.
    [[nodiscard]] bool holds_input_noise() const { return from_inputs > 0.5 * noise; }
  };

  /// Of the training blocks of a problem, which must outlive it.
  explicit MisfitScale(const Problem& problem);

  /// For what one fit leaves: the noise of recorded inputs counts too, as far as the model of that fit
  /// carries it to the channel and the fit does not follow it (noise::PropagateInputNoise); a fit under that
  /// noise (Refit::holds_input_noise) follows nothing of it. Such noise is a
  /// random walk where the model integrates. Where it is the larger part, the residual's root mean square is
  /// what is compared, with limits of four instead of ten times the level, and its autocorrelation says
  /// nothing.
  [[nodiscard]] MisfitScale At(const Refit& refit) const;

  /// Channels whose residual is at most twice a level that holds mostly noise of the inputs: that it is
  /// slow is no sign of a misfit.
  [[nodiscard]] std::vector<std::string> LikeInputNoise() const;

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

  /// Whether the level of a channel holds mostly noise of the inputs.
  [[nodiscard]] bool HoldsInputNoise(const std::string& channel) const;

  /// The noise of the measurement: that of a residual, but white with the level of this scale where the
  /// residual is a misfit, or the level holds mostly noise of the inputs.
  [[nodiscard]] noise::NoiseModel Floor(noise::NoiseModel residual) const;

 private:
  [[nodiscard]] const Channel* Find(const std::string& channel) const;
  [[nodiscard]] bool IsKnown(const noise::NoiseModel& noise) const;
  /// No deviation above so many levels, and none strongly autocorrelated.
  [[nodiscard]] bool Within(const noise::NoiseModel& noise, double of_stated, double of_differences) const;
  [[nodiscard]] bool IsMisfit(const noise::ChannelNoiseModel& residual) const;

  /// Deviation of what is left in a channel, over that of its noise; none of which is known.
  [[nodiscard]] static double Excess(const noise::ChannelNoiseModel& residual, const Channel& own);

  const Problem* problem_;
  std::vector<Channel> channels_;
};

/// The second of these conditions alone.
[[nodiscard]] bool StronglyAutocorrelated(const noise::ChannelNoiseModel& channel);

}  // namespace sinew::diagnosis
