// A foot that two muscles turn on the plate of a dynamometer.
#pragma once

#include <cmath>
#include <vector>

#include "models/dynamometer/strapped_foot.h"

namespace sinew {

inline FootGeometry StrappedGeometry() {
  FootGeometry foot;
  foot.straps = DefaultStraps();
  return foot;
}

/// Soleus and tibialis anterior.
inline std::vector<MusclePath> StrappedPaths() {
  return {{0.314, {-0.046, 0.002, 0.012}}, {0.316, {0.041, -0.006, -0.02}}};
}

template <class T = double>
StrappedFoot<T> StrappedPerson() {
  StrappedFoot<T> foot;
  HillMuscle<T> soleus;
  soleus.optimal_length = T(0.05);
  soleus.tendon_slack_length = T(0.262);
  soleus.isometric_force = T(3549.0);
  soleus.pennation = T(0.436);
  HillMuscle<T> tibialis;
  tibialis.optimal_length = T(0.098);
  tibialis.tendon_slack_length = T(0.223);
  tibialis.isometric_force = T(905.0);
  tibialis.pennation = T(0.087);
  foot.muscles = {soleus, tibialis};
  foot.history.assign(2, {T(0.0), T(0.0)});
  foot.boundary.sole_stiffness = T(5e6);
  foot.boundary.sole_compression = T(0.001);
  foot.boundary.friction = T(0.2);
  foot.boundary.strap_exponent = T(80.0);
  foot.boundary.axis_x = T(0.008);
  foot.boundary.axis_y = T(-0.005);
  return foot;
}

/// The plate swings from its highest angle down and up again [rad].
inline PlateMotion SwingAt(double time) {
  constexpr double kAmplitude = 0.35;
  constexpr double kMiddle = -0.1;
  constexpr double kRate = 4;
  return {kMiddle + kAmplitude * std::cos(kRate * time), -kAmplitude * kRate * std::sin(kRate * time),
          -kAmplitude * kRate * kRate * std::cos(kRate * time)};
}

/// Activations of the two muscles in turn, and their mean.
template <class T = double>
std::vector<T> BurstsAt(double time) {
  const double soleus = 0.3 - 0.28 * std::cos(5 * time);
  const double tibialis = 0.2 + 0.18 * std::cos(5 * time);
  return {T(soleus), T(tibialis), T(0.5 * (soleus + tibialis))};
}

}  // namespace sinew
