// Which parameters and effects the sensor of a channel has.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "identify/effect.h"
#include "identify/layout.h"
#include "identify/parameter.h"

namespace sinew {

/// The sensor effects, in the order of their parameters. Those before kTrialEffects can also act in a single
/// trial.
enum SensorEffect {
  kOffset,
  kDrift,
  kGain,
  kTimeOffset,
  kTrialEffects,
  kLowPass = kTrialEffects,
  kSaturation,
  kQuantisation,
  kSensorEffects
};

/// Properties of a measured channel from which bounds and probe values are derived.
struct ChannelSummary {
  std::string channel;
  std::string unit;
  double magnitude = 1;                ///< [unit] largest measured magnitude; 1 if all are zero
  double duration = 1;                 ///< [s] of the longest trial
  std::optional<double> quantisation;  ///< [unit] quantisation step of the measured values, if there is one
  std::vector<std::string> train_trials;
};

/// Summarises the compared blocks of `channel`.
[[nodiscard]] ChannelSummary Summarise(const Layout& layout, const std::string& channel);

/// Appends the effects that all trials share: CHANNEL.offset, .drift, .gain, .time_offset, .low_pass,
/// .saturation, .quantisation. @return the index of the first parameter.
int AddSensorEffects(const ChannelSummary& channel, std::vector<Parameter>& parameters,
                     std::vector<Effect>& effects);

/// Appends those of one trial: CHANNEL.offset@TRIAL, .drift@TRIAL, .gain@TRIAL, .time_offset@TRIAL. @return
/// the index of the first parameter.
int AddTrialEffects(const ChannelSummary& channel, const std::string& trial,
                    std::vector<Parameter>& parameters, std::vector<Effect>& effects);

}  // namespace sinew
