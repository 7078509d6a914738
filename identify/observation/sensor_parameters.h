// Which parameters and effects the sensor of a channel has.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "identify/effect.h"
#include "identify/layout.h"
#include "identify/parameter.h"

namespace sinew {

/// What a sensor may do, in the order of its parameters. Those before kTrialEffects can also happen in a
/// single trial.
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

/// What the measurement tells of a channel: from this come bounds and probes.
struct ChannelSummary {
  std::string channel;
  std::string unit;
  double magnitude = 1;                ///< [unit] largest measured magnitude; 1 if all are zero
  double duration = 1;                 ///< [s] of the longest trial
  std::optional<double> quantisation;  ///< [unit] step of which the measured values are multiples
  std::vector<std::string> train_trials;
};

/// Of the blocks of `channel` that are compared.
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
