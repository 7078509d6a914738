// The thesis's subject- and task-specific EMG model: mean shapes over a cycle, scaled with speed. SCIENCE
// section 5, model (a).
//
//   emg_ms(k)  mean envelope of muscle m over the cycles at speed s, K = 2000 samples a cycle     (eq 6.1)
//   EMG_m(k) = (1 / S) sum_s emg_ms(k)                                                           (eq 6.2)
//   factor_m(s) = max_k emg_ms(k) / max_k EMG_m(k),  a function of speed by regression or interpolation
//   predicted(phase, speed) = factor_m(speed) EMG_m(phase)
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "base/error.h"
#include "models/emg/cycle_warp.h"
#include "models/emg/cycles.h"
#include "models/emg/shape_factor.h"

namespace sinew {

/// The recorded cycles at one speed, without those that were left out.
struct SpeedCycles {
  double speed = 0;  ///< of the movement [rad/s, finite]
  /// [muscles][cycles][K]; each from WarpCycle. The muscles need not have equally many.
  std::vector<std::vector<std::vector<double>>> muscles;
};

struct AveragedEmgSettings {
  FactorLaw law = FactorLaw::kRegression;
  std::size_t fewest_cycles = 2;  ///< a muscle's speed with fewer cycles is left out [>= 1]
};

/// The model of one muscle.
struct MuscleAverage {
  std::string name;
  std::size_t cycles = 0;            ///< in all
  std::vector<double> speeds;        ///< [S, rad/s], increasing: those that count
  std::vector<MeanCurve> at_speeds;  ///< [S]
  std::vector<double> shape;         ///< EMG_m [K]
  double peak = 0;                   ///< of the shape
  std::vector<double> factors;       ///< measured [S]
  /// Standard deviation of a cycle about the model, with factor 1 [K]: of cycle / factor(speed) - shape over
  /// all cycles, n - 1. It contains the scatter from cycle to cycle and the error of the model at the speeds
  /// it was built from.
  std::vector<double> spread;
};

class AveragedEmg {
 public:
  /// Muscles and speeds with too few cycles or without signal are left out, with a note in `notes`.
  static Result<AveragedEmg> Build(const std::vector<std::string>& muscles,
                                   const std::vector<SpeedCycles>& speeds,
                                   const AveragedEmgSettings& settings);

  [[nodiscard]] std::size_t muscle_count() const { return muscles_.size(); }
  [[nodiscard]] const MuscleAverage& muscle(std::size_t index) const { return muscles_[index]; }
  /// False: the muscle has no shape (no cycles, or no signal), its predictions are NaN.
  [[nodiscard]] bool has(std::size_t muscle) const { return !muscles_[muscle].shape.empty(); }
  /// @param muscle that has() @return its shape factor
  [[nodiscard]] const ShapeFactor& factor(std::size_t muscle) const { return factors_[muscle].front(); }
  /// What was left out of the building and why, sentences.
  [[nodiscard]] const std::vector<std::string>& notes() const { return notes_; }

  /// @param speed [rad/s] @param phase of the cycle [0..1] @return [unit of the envelopes, >= 0]
  [[nodiscard]] double At(std::size_t muscle, double speed, double phase) const;
  /// Standard deviation of a single cycle there, factor(speed) spread(phase); without what the factor itself
  /// may be wrong by. NaN if the muscle has a single cycle.
  [[nodiscard]] double SpreadAt(std::size_t muscle, double speed, double phase) const;

  /// One cycle in time: samples at 0, 1 / rate, ... up to its duration [unit of the envelopes].
  [[nodiscard]] std::vector<double> PredictCycle(std::size_t muscle, double speed, double duration_s,
                                                 double rate_Hz) const;

  /// At each time, by the cycle it lies in and that cycle's speed; NaN between cycles. O(N + cycles).
  /// @param time [N, s, increasing] @param cycles in the order of time
  [[nodiscard]] std::vector<double> PredictRecording(std::size_t muscle, const std::vector<double>& time,
                                                     const std::vector<MovementCycle>& cycles) const;

  /// A sentence if the speed is outside of the measured ones of this muscle; else empty.
  [[nodiscard]] std::string RangeWarning(std::size_t muscle, double speed) const;

 private:
  AveragedEmg() = default;
  std::vector<MuscleAverage> muscles_;
  std::vector<std::vector<ShapeFactor>> factors_;  // [M][0 or 1]
  std::vector<std::string> notes_;
};

}  // namespace sinew
