// History dependence of muscle force: enhancement after stretch and depression after shortening.
#pragma once

#include <cmath>

#include "base/dual.h"

namespace sinew {

/// Factor on the active force, (1 + enhancement S) (1 - depression D): S and D are the stretch and the
/// shortening of the fibre so far [optimal lengths], with exponential decay. Physiologically both last as
/// long as the muscle is active; the decay represents muscles that are active in turns.
/// Source: Abbott, Aubert (1952), J. Physiol. 117:77-86; the linear dependence on the distance: Edman,
/// Elzinga, Noble (1978), J. Physiol. 281:139-155; Marechal, Plaghki (1979), J. Gen. Physiol. 73:453-467.
template <class T>
class ForceHistory {
 public:
  static constexpr double kTimeConstant = 2;  ///< [s]
  static constexpr double kMinimum = 0.05;    ///< the factor never falls below

  /// @param enhancement, depression per optimal length [1]
  ForceHistory(const T& enhancement, const T& depression)
      : enhancement_(enhancement), depression_(depression) {}

  /// @param time [s], increasing @param velocity of the fibre [optimal lengths per second, positive:
  /// lengthening]
  void Pass(double time, const T& velocity) {
    if (any_) {
      const double step = time - time_;
      const double kept = std::exp(-step / kTimeConstant);
      stretch_ = kept * stretch_ + (0.5 * step) * (Positive(velocity) + Positive(velocity_));
      shortening_ = kept * shortening_ + (0.5 * step) * (Positive(-velocity) + Positive(-velocity_));
    }
    any_ = true;
    time_ = time;
    velocity_ = velocity;
  }

  [[nodiscard]] T Factor() const {
    const T factor = (1.0 + enhancement_ * stretch_) * (1.0 - depression_ * shortening_);
    return Value(factor) > kMinimum ? factor : T(kMinimum);
  }

 private:
  static T Positive(const T& x) { return Value(x) > 0 ? x : T(0.0); }

  T enhancement_;
  T depression_;
  bool any_ = false;
  double time_ = 0;
  T velocity_{0.0};
  T stretch_{0.0};
  T shortening_{0.0};
};

}  // namespace sinew
