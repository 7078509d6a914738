// Smooth random errors of a recorded motion, for synthetic data.
#pragma once

#include <array>

#include "base/random.h"
#include "problems/contact/laboratory/stepping_robot.h"

namespace sinew {

/// Errors of the six components of a foot's pose over time: independent Gaussian processes with the
/// correlation exp(-lag^2 / (2 correlation_time^2)), which is 0.61 after the correlation time. Each is a sum
/// of sines and cosines with normal weights and frequencies drawn from that correlation's spectrum: no
/// splines, knots or frequencies that a fit could share. Source: Rahimi, Recht (2007), Random features for
/// large-scale kernel machines, NIPS 20.
class SmoothErrors {
 public:
  /// @param position, rotation standard deviations [m, rad] @param correlation_time [s, > 0]
  SmoothErrors(double position, double rotation, double correlation_time, Random& random);

  [[nodiscard]] FootError At(double time) const;

 private:
  static constexpr std::size_t kWaves = 64;
  struct Wave {
    double frequency = 0;  // [rad/s]
    double cosine = 0;     // [m or rad]
    double sine = 0;
  };
  std::array<std::array<Wave, kWaves>, 6> waves_;
};

}  // namespace sinew
