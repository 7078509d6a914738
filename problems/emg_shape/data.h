// Recorded trials as the emg_shape problems see them: where in its cycle every sample is, and which samples
// are compared.
#pragma once

#include <string>
#include <vector>

#include "base/error.h"
#include "datasets/dataset.h"
#include "identify/layout.h"
#include "models/emg/cycles.h"
#include "models/emg/shape_basis.h"
#include "problems/emg_shape/learning/cycle_scatter.h"
#include "problems/emg_shape/learning/windows.h"
#include "problems/emg_shape/settings.h"

namespace sinew {

/// By how much bursts of one muscle in one recording scatter more, or less, than is usual.
struct EmgScatterFactors {
  double gain = 1;
  double timing = 1;
};

struct EmgShapeTrial {
  std::string name;
  BlockRole role = BlockRole::kTrain;
  double speed = 0;   ///< [rad/s]: condition speed_rad_per_s, else the cycles' mean absolute speed
  double period = 0;  ///< median duration of its cycles [s]
  int group = 0;      ///< index into EmgShapeData::speeds
  std::vector<MovementCycle> cycles;
  std::vector<double> time;   ///< [M, s] of the predictions
  std::vector<double> phase;  ///< [M, cycles] from the beginning of the cycle in `cycle`; before
                              ///< the first and after the last it runs on
  std::vector<int> cycle;     ///< [M] index of the cycle
  std::vector<double> angle;  ///< [M, rad]
  std::vector<std::vector<double>> others;      ///< [muscles][M] mean EMG of the others; empty: not known
  std::vector<std::vector<EmgWindow>> windows;  ///< [muscles]; all of a training trial, else none
  /// [muscles] 1 where nothing is known of the speed.
  std::vector<EmgScatterFactors> scatter;
  int first_block = 0;  ///< one per muscle
};

struct EmgSpeed {
  double speed = 0;      ///< [rad/s] of its first trial
  std::string label;     ///< "0.524"
  bool trained = false;  ///< a training trial has it
};

/// Estimates for a muscle from the cycles of the training trials, before anything is fitted.
struct EmgMuscle {
  std::string name;
  Vector shape;              ///< [knots] at the reference speed
  BurstPattern bursts;       ///< of that shape
  double noise = 0;          ///< standard deviation within cycles, at the compared samples
  ModulatedNoise modulated;  ///< and how it depends on the EMG's mean at that phase
  std::vector<double> mean;  ///< EMG over one cycle, mean of the training trials; [0] and the end are one
  Vector mean_shape;         ///< [knots, of a plain ShapeBasis] the same; empty: not known
  Scatter gain;              ///< of bursts, of the logarithm
  Scatter timing;            ///< of bursts [cycle]
};

struct EmgShapeData {
  std::vector<EmgMuscle> muscles;
  std::vector<EmgSpeed> speeds;  ///< increasing
  std::vector<EmgShapeTrial> trials;
  EmgReference reference;
  int knots = 0;                     ///< of shapes
  std::vector<Vector> others_shape;  ///< [muscles] mean of the others' mean_shape; empty: not known
  double shared_timing = 0;  ///< standard deviation of what all muscles have in common in a cycle [cycle]
  Layout layout;             ///< block of trial t and muscle m: trials[t].first_block + m
  std::vector<std::string> notes;

  [[nodiscard]] int trained_speeds() const;
};

/// What shapes are made of, as the envelopes' filter shows them in cycles of this period [s]. @param jitter
/// of the cycles whose mean it is [cycle]
[[nodiscard]] ShapeBasis BasisOf(const EmgShapeSettings& settings, int knots, double period,
                                 double jitter = 0);

[[nodiscard]] std::string DescribeEmgShapeChannels();

/// Cycles that are incomplete, have gaps or another duration, and those of a muscle without signal, saturated
/// or with gaps are left out, and counted in the notes. So are training trials and muscles of trials with
/// fewer than two cycles.
///
/// Errors, with the trial's name: no angle, another unit, no excitations in a training trial; no training
/// trial and no `reference` in the settings; no muscle that can be learnt from.
Result<EmgShapeData> PrepareEmgShapeData(const Dataset& data, const EmgShapeSettings& settings);

}  // namespace sinew
