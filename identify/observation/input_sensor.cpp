#include "identify/observation/input_sensor.h"

#include <utility>

namespace sinew {
namespace {

constexpr double kLargestInputOffset = 0.1;  // [s]
constexpr double kSlowestInput = 0.1;        // [s]
constexpr double kInputGainReach = 0.9;      // [1]

}  // namespace

InputSensor AddInputSensor(const std::string& input, const std::string& unit, double magnitude,
                           double duration, std::vector<Parameter>& parameters,
                           std::vector<Effect>& effects) {
  const auto add = [&](const char* kind, const std::string& of_unit, double lower, double null, double upper,
                       const char* meaning, const char* revealing_experiment) {
    const std::string name = input + "." + kind;
    const int index = static_cast<int>(parameters.size());
    effects.push_back({name, Level::kSensor, input + ": " + meaning, revealing_experiment, {index}});
    parameters.push_back(EffectParameter(name, of_unit, meaning, lower, upper, null, name));
    return index;
  };
  const double steepest = magnitude / duration;
  InputSensor sensor;
  sensor.offset =
      add("offset", unit, -magnitude, 0, magnitude, "the sensor of this input reads too much by a constant",
          "a rest phase, where the true input is known");
  sensor.drift =
      add("drift", unit + "/s", -steepest, 0, steepest, "the reading of this input drifts with time",
          "rest phases at the begin and at the end of a long trial");
  sensor.gain =
      add("gain", "1", 1 - kInputGainReach, 1, 1 + kInputGainReach,
          "the sensor of this input reads too much by a factor", "a known load on the sensor of the input");
  sensor.time_offset = add("time_offset", "s", -kLargestInputOffset, 0, kLargestInputOffset,
                           "the clock of this input is late against the other instruments",
                           "one sharp event that all instruments see, at a high sampling rate");
  sensor.low_pass =
      add("low_pass", "s", 0, 0, kSlowestInput, "the recorded input is smoothed by a first-order low-pass",
          "a sudden event recorded without the filter, at a high sampling rate");
  return sensor;
}

}  // namespace sinew
