// Friction of one spring, and the load of its force on a plate.
#pragma once

#include <array>
#include <cmath>

#include "models/contact/contact_sums.h"

namespace sinew {

/// Friction per unit of normal force and of slip, and its derivative for the slip speed over the speed, for
/// mu_s, mu_d, mu_v = 1 (thesis eq 5.2, smooth where the slip is zero).
struct FrictionPerSlip {
  std::array<double, 3> value{};
  std::array<double, 3> slope{};
};

inline FrictionPerSlip FrictionPerSlipAt(double slip, double transition_velocity) {
  const double ratio = slip / transition_velocity;
  const double peak = 2 / (1 + ratio * ratio);
  const double peak_slope = -peak * peak / (transition_velocity * transition_velocity);  // over the slip
  FrictionPerSlip f;
  if (ratio < 1) {
    f.value = {peak / transition_velocity, (1 - peak) / transition_velocity, 1};
    f.slope = {peak_slope / transition_velocity, -peak_slope / transition_velocity, 0};
  } else {
    const double cubed = slip * slip * slip;
    f.value = {peak / slip, (1 - peak) / slip, 1};
    f.slope = {peak_slope / slip - peak / cubed, -peak_slope / slip - (1 - peak) / cubed, 0};
  }
  return f;
}

/// The potential of that friction per unit of normal force [m/s]: its derivative for the slip is the
/// friction.
/// @param mu mu_s, mu_d, mu_v
inline double FrictionPotentialAt(double slip, double transition_velocity, const std::array<double, 3>& mu) {
  constexpr double kAtTransition = 0.785398163397448310;  // arctan 1
  constexpr double kLogTwo = 0.693147180559945309;
  const double ratio = slip / transition_velocity;
  const double over = mu[0] - mu[1];
  const double dry = ratio < 1 ? 0.5 * mu[1] * ratio * ratio + over * std::log1p(ratio * ratio)
                               : 0.5 * mu[1] + over * kLogTwo + mu[1] * (ratio - 1) +
                                     2 * over * (std::atan(ratio) - kAtTransition);
  return transition_velocity * dry + 0.5 * mu[2] * slip * slip;
}

/// Where a force acts on the plate, and the load of it.
struct Lever {
  double x = 0;
  double z = 0;
  [[nodiscard]] ContactLoad Of(double fx, double fy, double fz) const {
    ContactLoad load;
    load << fx, fy, fz, z * fx - x * fz, x * fy, z * fy;
    return load;
  }
};

}  // namespace sinew
