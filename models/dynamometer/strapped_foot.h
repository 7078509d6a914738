// A foot on the plate of a dynamometer whose angle is prescribed: muscles, passive ankle, weight, sole and
// straps. SCIENCE section 6.
//
//   I q'' = sum of muscles arm F + passive moment + weight + sole and straps + unknown moment
#pragma once

#include <algorithm>
#include <utility>
#include <vector>

#include "models/dynamometer/attachment.h"
#include "models/dynamometer/boundary.h"
#include "models/dynamometer/muscle_path.h"
#include "models/dynamometer/passive_ankle.h"
#include "models/dynamometer/unknown_moment.h"
#include "models/muscle/hill_muscle.h"

namespace sinew {

/// A force that relaxes: a spring in series with a damper. T is double or Dual.
template <class T>
struct Relaxation {
  T stiffness{0.0};  ///< of the spring [N m/rad, >= 0]
  T time{0.5};       ///< constant [s, > 0]
};

/// What the equations know of a person and a machine. T is double or Dual.
template <class T>
struct StrappedFoot {
  std::vector<HillMuscle<T>> muscles;
  std::vector<std::pair<T, T>> history;  ///< [muscles] enhancement and depression, see ForceHistory
  bool remembers = false;                ///< one of them, or a derivative for it, is not 0
  T antagonist{0.0};  ///< plantarflexing moment of a muscle without electrode, whose activation is the mean
                      ///< of the others' [N m]
  PassiveAnkle<T> passive;
  Relaxation<T> passive_relaxation;   ///< of the ankle
  Relaxation<T> boundary_relaxation;  ///< of what is between foot and plate
  BoundaryLaw<T> boundary;
  Attachment<T> attachment;
  UnknownMoment<T> unknown;  ///< about the ankle
};

/// The same without derivatives, in the numbers that a search for an angle needs.
template <class To, class From>
StrappedFoot<To> Converted(const StrappedFoot<From>& from) {
  const auto c = [](const From& x) { return To(Value(x)); };
  StrappedFoot<To> to;
  for (const HillMuscle<From>& m : from.muscles) {
    to.muscles.push_back({c(m.optimal_length), c(m.tendon_slack_length), c(m.isometric_force), c(m.strength),
                          c(m.pennation), c(m.length_change), c(m.damping), c(m.largest_velocity),
                          c(m.compliance), c(m.active_gain)});
  }
  for (const auto& [enhancement, depression] : from.history)
    to.history.emplace_back(c(enhancement), c(depression));
  to.remembers = from.remembers;
  const PassiveAnkle<From>& p = from.passive;
  to.passive = {c(p.stiffness),        c(p.exponent), c(p.rest_angle),
                c(p.linear_stiffness), c(p.damping),  c(p.hysteresis)};
  to.passive_relaxation = {c(from.passive_relaxation.stiffness), c(from.passive_relaxation.time)};
  to.boundary_relaxation = {c(from.boundary_relaxation.stiffness), c(from.boundary_relaxation.time)};
  const BoundaryLaw<From>& b = from.boundary;
  to.boundary = {c(b.sole_stiffness),  c(b.sole_dissipation), c(b.sole_compression),
                 c(b.sole_exponent),   b.bent_sole,           c(b.friction),
                 c(b.strap_stiffness), c(b.strap_exponent),   c(b.strap_pretension),
                 c(b.strap_damping),   c(b.strap_loosening),  c(b.axis_x),
                 c(b.axis_y)};
  to.antagonist = c(from.antagonist);
  to.unknown.knots = from.unknown.knots;
  to.unknown.acts = from.unknown.acts;
  for (std::size_t i = 0; i < kMomentSignals; ++i)
    std::transform(from.unknown.weights[i].begin(), from.unknown.weights[i].end(),
                   to.unknown.weights[i].begin(), c);
  return to;
}

/// Moment of the foot's weight about the ankle [N m].
template <class A>
[[nodiscard]] A WeightOfFoot(const FootGeometry& foot, const A& ankle_angle) {
  const A angle = ankle_angle - foot.shank_tilt;
  return -foot.mass * foot.gravity * (foot.mass_x * cos(angle) - foot.mass_y * sin(angle));
}

/// Motion of the plate at one instant.
struct PlateMotion {
  double angle = 0;         ///< [rad]
  double velocity = 0;      ///< [rad/s]
  double acceleration = 0;  ///< [rad/s2]
};

}  // namespace sinew
