#include "models/muscle/hill_muscle.h"

#include <cmath>

namespace sinew {

// Lloyd and Besier's curves (2003) as CEINMS ships them; points that only keep a natural spline flat are left
// out.
MuscleCurves MuscleCurves::Default() {
  const auto smooth = [](const std::vector<double>& x, const std::vector<double>& y) {
    return *MuscleCurve::Smooth(x, y);
  };
  return {smooth({0, 0.4035, 0.52725, 0.62875, 0.71875, 0.86125, 1.045, 1.2175, 1.43875, 1.61875, 2.2},
                 {0, 0, 0.226667, 0.636667, 0.856667, 0.95, 0.993333, 0.77, 0.246667, 0, 0}),
          smooth({0, 1, 1.1, 1.2, 1.3, 1.4, 1.5, 1.6}, {0, 0, 0.035, 0.12, 0.26, 0.55, 1.17, 2}),
          smooth({-10, -1, -0.6, -0.3, -0.1, 0, 0.1, 0.3, 0.6, 0.8, 10},
                 {0, 0, 0.08, 0.2, 0.55, 1, 1.4, 1.6, 1.7, 1.75, 1.75}),
          smooth({-1, 0, 0.00131, 0.00281, 0.00431, 0.00581, 0.00731, 0.00881, 0.0103, 0.0118, 0.0123, 9.2},
                 {0, 0, 0.0108, 0.0257, 0.0435, 0.0652, 0.0915, 0.123, 0.161, 0.208, 0.227, 345})};
}

Pull PullAt(const MuscleCurves& curves, const HillMuscle<double>& muscle, double sine_at_optimal,
            double length, double velocity, double activation) {
  Pull by;
  by.cosine = std::sqrt(1 - kLargestSine * kLargestSine);
  const double sine = muscle.optimal_length * sine_at_optimal / length;
  if (sine < kLargestSine) {
    by.cosine = std::sqrt(1.0 - sine * sine);
    by.cosine_by_thickness = -sine / (length * by.cosine);
    by.cosine_by_length = -by.cosine_by_thickness * sine;
  }
  const double per_length = 1.0 / muscle.optimal_length;
  const double stretch = length * per_length;
  const double optimal = 1.0 + muscle.length_change * (1.0 - activation);
  const double speed = velocity * per_length / muscle.largest_velocity;
  const auto reach = curves.active_force_length.At(stretch / optimal);
  const auto moving = curves.force_velocity.At(speed);
  const auto passive = curves.passive_force_length.At(stretch);
  const double active = reach.value * moving.value * activation * muscle.active_gain;
  const double strength = muscle.isometric_force * muscle.strength;
  const double share = active + passive.value + muscle.damping * speed;
  const double force = strength * share;
  by.value = force * by.cosine;
  const double along = strength * by.cosine;
  const double gain = activation * muscle.active_gain;
  const double by_reduced =
      along * reach.slope * moving.value * gain;  // by length over that of optimal force
  const double by_stretch = by_reduced / optimal + along * passive.slope;
  const double by_speed = along * (reach.value * moving.slope * gain + muscle.damping);
  const double by_optimal = -by_reduced * stretch / (optimal * optimal);
  by.length = by_stretch * per_length + force * by.cosine_by_length;
  by.velocity = by_speed * per_length / muscle.largest_velocity;
  by.activation = along * reach.value * moving.value * muscle.active_gain - by_optimal * muscle.length_change;
  by.optimal_length = -(by_stretch * stretch + by_speed * speed) * per_length;
  by.thickness = force * by.cosine_by_thickness;
  by.strength = share * by.cosine;
  by.length_change = by_optimal * (1.0 - activation);
  by.damping = along * speed;
  by.largest_velocity = -by_speed * speed / muscle.largest_velocity;
  by.active_gain = along * reach.value * moving.value * activation;
  return by;
}

}  // namespace sinew
