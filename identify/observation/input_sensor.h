// Correction of a measured input for its sensor, before the input drives a model.
//
//   true(t) = (u(t + time_offset) + low_pass * du/dt(t + time_offset) - offset - drift * (t - middle)) / gain
#pragma once

#include <string>
#include <vector>

#include "base/linear_algebra.h"
#include "identify/effect.h"
#include "identify/parameter.h"

namespace sinew {

/// Parameters of an input's sensor; with these defaults the input is unchanged.
template <class T>
struct InputCorrection {
  T offset = T(0);       ///< [unit] constant that the sensor adds
  T drift = T(0);        ///< [unit/s]
  T gain = T(1);         ///< [1, > 0]
  T time_offset = T(0);  ///< [s] delay of the reading
  T low_pass = T(0);     ///< [s, >= 0] time constant of the sensor's first-order low-pass
};

/// The input before its sensor: the inverse of low-pass, delay, gain, offset and drift, in that order. For a
/// reading that can be differentiated (a spline).
/// @param from_middle [s] time since the middle of the trial
/// @param reading [unit] u at t + time_offset @param slope [unit/s] du/dt there
template <class T>
T CorrectedInput(const InputCorrection<T>& sensor, double from_middle, const T& reading, const T& slope) {
  return (reading + sensor.low_pass * slope - sensor.offset - sensor.drift * from_middle) / sensor.gain;
}

/// Indices of the parameters of an input's sensor.
struct InputSensor {
  int offset = 0;
  int drift = 0;
  int gain = 0;
  int time_offset = 0;
  int low_pass = 0;

  [[nodiscard]] InputCorrection<double> At(const Vector& parameters) const {
    return {parameters[offset], parameters[drift], parameters[gain], parameters[time_offset],
            parameters[low_pass]};
  }
};

/// Appends INPUT.offset, .drift, .gain, .time_offset and .low_pass and an effect (of the sensor) for each.
/// @param magnitude [unit, > 0] largest magnitude of the input @param duration [s, > 0] of the longest trial:
/// bounds of offset and drift
InputSensor AddInputSensor(const std::string& input, const std::string& unit, double magnitude,
                           double duration, std::vector<Parameter>& parameters, std::vector<Effect>& effects);

}  // namespace sinew
