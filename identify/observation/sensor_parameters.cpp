#include "identify/observation/sensor_parameters.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "identify/observation/quantisation.h"

namespace sinew {
namespace {

constexpr double kLatest = 0.1;     // [s]
constexpr double kSlowest = 0.5;    // [s]
constexpr double kGainReach = 0.9;  // [1]
// As shares of the largest measured magnitude: probe values of the saturation limit, and its lower bound.
constexpr double kLimits[] = {0.95, 0.85, 0.7};
constexpr double kLowestLimit = 0.5;
// As shares of the largest measured magnitude: the largest quantisation step, and the step to use if the
// values show none.
constexpr double kCoarsestStep = 0.25;

Parameter Describe(SensorEffect effect, const ChannelSummary& channel) {
  Parameter p;
  p.kind = ParameterKind::kEffect;
  const auto set = [&](const char* name, std::string unit, const char* meaning, double lower, double null,
                       double upper) {
    p.name = channel.channel + "." + name;
    p.unit = std::move(unit);
    p.meaning = meaning;
    p.lower = lower;
    p.upper = upper;
    p.start = null;
    p.null_value = null;
  };
  const double most = channel.magnitude;
  const double steepest = most / channel.duration;
  switch (effect) {
    case kOffset:
      set("offset", channel.unit, "the sensor reads too much by a constant", -most, 0, most);
      break;
    case kDrift:
      set("drift", channel.unit + "/s", "the sensor's reading drifts with time", -steepest, 0, steepest);
      break;
    case kGain:
      set("gain", "1", "the sensor reads too much by a factor", 1 - kGainReach, 1, 1 + kGainReach);
      break;
    case kTimeOffset:
      set("time_offset", "s", "the sensor's clock is late against the other instruments", -kLatest, 0,
          kLatest);
      break;
    case kLowPass:
      set("low_pass", "s", "the recorded channel is smoothed by a first-order low-pass", 0, 0, kSlowest);
      break;
    case kSaturation:
      set("saturation", "1/" + channel.unit, "the sensor saturates (inverse of the limit of its reading)", 0,
          0, 1 / (kLowestLimit * most));
      for (const double limit : kLimits) p.probes.push_back(1 / (limit * most));
      p.null_step = p.probes.front();
      break;
    case kQuantisation:
      set("quantisation", channel.unit, "the recorded values are rounded to multiples of a step", 0, 0,
          kCoarsestStep * most);
      // Values that are not multiples of a step were not rounded: there is no probe value, and the slope at
      // the null is zero.
      p.is_rounding_step = true;
      if (channel.quantisation) p.probes = {*channel.quantisation};
      p.null_step = channel.quantisation.value_or(0);
      p.upper = std::max(p.upper, 2 * p.null_step);
      break;
    case kSensorEffects:
      break;
  }
  return p;
}

const char* ExposedBy(SensorEffect effect) {
  switch (effect) {
    case kOffset:
      return "rest phases at several values, one of them known by other means";
    case kDrift:
      return "rest phases at several values, at the begin and at the end of a long trial";
    case kGain:
      return "a true value that is known by other means, or a trial over a wider range";
    case kTimeOffset:
      return "a trigger that all instruments record, at a high sampling rate";
    case kLowPass:
      return "a sudden event (a drop, a tap) recorded without the filter, at a high sampling rate";
    case kSaturation:
      return "a trial with larger values, or with a sensor of a wider range";
    case kQuantisation:
      return "a slow ramp, where the steps can be seen one by one";
    case kSensorEffects:
      break;
  }
  return "";
}

// A wrong zero is common; a drift, a filter and a limit are known to whoever has chosen the instrument.
Occurrence OccurrenceOf(SensorEffect effect, const std::string& trial) {
  if (!trial.empty()) return Occurrence::kRare;
  if (effect == kOffset) return Occurrence::kCommon;
  return effect == kGain || effect == kTimeOffset ? Occurrence::kOccasional : Occurrence::kRare;
}

int Add(SensorEffect effect, const ChannelSummary& channel, const std::string& trial,
        std::vector<Parameter>& parameters, std::vector<Effect>& effects) {
  Parameter p = Describe(effect, channel);
  std::string where = channel.channel;
  if (!trial.empty()) {
    p.name += "@" + trial;
    p.trial = trial;
    p.meaning += " in this trial alone";
    where += " in trial " + trial + " alone";
  }
  p.effect = p.name;
  const int index = static_cast<int>(parameters.size());
  const std::string description = Describe(effect, channel).meaning;
  effects.push_back({p.name,
                     Level::kSensor,
                     where + ": " + description,
                     ExposedBy(effect),
                     {index},
                     trial,
                     OccurrenceOf(effect, trial)});
  parameters.push_back(std::move(p));
  return index;
}

}  // namespace

ChannelSummary Summarise(const Layout& layout, const std::string& channel) {
  ChannelSummary summary;
  summary.channel = channel;
  summary.magnitude = 0;
  summary.duration = 0;
  std::vector<double> measured;
  for (const Block& block : layout) {
    if (block.channel != channel || block.role == BlockRole::kPredicted) continue;
    summary.unit = block.unit;
    measured.insert(measured.end(), block.measured.begin(), block.measured.end());
    summary.duration =
        std::max(summary.duration, block.prediction_time.back() - block.prediction_time.front());
    if (block.role == BlockRole::kTrain) summary.train_trials.push_back(block.trial);
  }
  for (const double value : measured) summary.magnitude = std::max(summary.magnitude, std::abs(value));
  if (summary.magnitude == 0) summary.magnitude = 1;
  if (summary.duration == 0) summary.duration = 1;
  summary.quantisation = QuantisationStep(measured);
  return summary;
}

int AddSensorEffects(const ChannelSummary& channel, std::vector<Parameter>& parameters,
                     std::vector<Effect>& effects) {
  const int first = static_cast<int>(parameters.size());
  for (int effect = 0; effect < kSensorEffects; ++effect) {
    Add(static_cast<SensorEffect>(effect), channel, "", parameters, effects);
  }
  return first;
}

int AddTrialEffects(const ChannelSummary& channel, const std::string& trial,
                    std::vector<Parameter>& parameters, std::vector<Effect>& effects) {
  const int first = static_cast<int>(parameters.size());
  for (int effect = 0; effect < kTrialEffects; ++effect) {
    Add(static_cast<SensorEffect>(effect), channel, trial, parameters, effects);
  }
  return first;
}

}  // namespace sinew
