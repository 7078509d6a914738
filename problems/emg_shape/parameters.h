// What is identified of a person's EMG in a cyclic movement, and what may be wrong with that model.
//
//   emg = floor_m + sum over bursts b of exp(gain + gain_b) share_b(place + timing_b)
//                                                           S_m(phase + timing + timing_b)
//
// and where an electrode records the share c of the others (EmgShapeTrial::others), S_m holds their mean:
//
//   emg = floor_m + sum over bursts b of exp(gain + (1 + c r_b) gain_b) share_b (S_m - c O_m) + c others
//
//   gain   = exponent_m ln(s / s0) + gain@s.m
//   timing = phase_m + (lead + lead_m) (1 / T(s) - 1 / T0) + timing@s + timing@s.m
//
// share_b: how much of S_m is burst b's (EmgWindow); bursts overlap, and each has its gain and timing.
// O_m: mean of the others over a cycle; r_b: its ratio to m's own mean in the burst. gain_b scatters as the
// burst does that was measured, which contains the others, and whose own part scatters more; so does the
// muscle's own timing_b, and not what all muscles of a cycle have in common.
// s speed, T period of a cycle; s0, T0 those of the reference. docs/decisions/emg_shape_model.md.
#pragma once

#include <vector>

#include "problems/emg_shape/data.h"
#include "problems/kit/parameter_list.h"

namespace sinew {

// Priors (standard deviations): how far people's EMG at one speed is from a law of all speeds. Chosen on the
// prototype of docs/decisions/emg_shape_model.md.
constexpr double kSpeedTiming = 0.02;        ///< of all muscles together [cycle]
constexpr double kSpeedMuscleTiming = 0.01;  ///< of one beyond it [cycle]
constexpr double kSpeedGain = 0.1;           ///< of the logarithm

/// How a parameter enters the prediction of one muscle in one trial.
enum class EmgTerm {
  kShape,     ///< a control point of S
  kOffset,    ///< adds to the EMG
  kGain,      ///< adds to the log gain
  kTiming,    ///< adds to the phase at which S is read [cycle]
  kCrossTalk  ///< c
};

/// What the parameter is multiplied with at every sample, besides `factor`.
enum class EmgAlong {
  kOne,
  kCycle,      ///< number of the cycle from the recording's middle
  kSine,       ///< of the phase
  kCosine,     ///< of the phase, less 1: nothing moves at the beginning
  kBasis,      ///< a linear basis function of the time in the trial
  kWindow,     ///< of gains and timings: they are those of one EmgWindow
  kAllMuscles  ///< of timings: the same, of all muscles together
};

struct EmgColumn {
  int parameter = 0;
  EmgTerm term = EmgTerm::kOffset;
  EmgAlong along = EmgAlong::kOne;
  int which = 0;  ///< control point, basis function or window
  double factor = 1;
};

struct EmgShapeParameters : ParameterList {
  std::vector<double> hat_knots;                ///< [s] in the trial, of EmgAlong::kBasis
  std::vector<std::vector<EmgColumn>> columns;  ///< [blocks of the layout], parameters increasing
};

[[nodiscard]] EmgShapeParameters ListEmgShapeParameters(const EmgShapeSettings& settings,
                                                        const EmgShapeData& data);

}  // namespace sinew
