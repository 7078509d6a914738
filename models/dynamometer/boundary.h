// What passes between a foot and the plate that it is strapped to: a bed of springs under the sole and straps
// over the foot. SCIENCE section 4 and 6.
//
//   sole, per strip   n = k a d (d / 5 mm)^e (1 + c v), never pulling, with Hollars friction
//   strap             s = (S + (K / b) (exp(b x) - 1)) (1 + g v), never pushing
//
// d depth, x lengthening since the foot was strapped on, v the rate of either; thesis eq 5.1 and 5.2; the
// straps' law is the usual one of soft tissue (Fung 1967, Am. J. Physiol. 213:1532-1544).
#pragma once

#include "base/dual_math.h"
#include "models/dynamometer/foot_geometry.h"
#include "models/dynamometer/planar.h"
#include "models/dynamometer/sole_bed.h"

namespace sinew {

/// T is double or Dual.
template <class T>
struct BoundaryLaw {
  T sole_stiffness{2e6};      ///< k [N/m3, > 0]
  T sole_dissipation{0.5};    ///< c [s/m, >= 0]
  T sole_compression{0.002};  ///< depth of the sole at p = q = 0 [m]
  T sole_exponent{0.0};       ///< e: beyond that of a linear spring [1, > -1]
  bool bent_sole = false;     ///< the exponent, or a derivative for it, is not 0
  T friction{0.5};            ///< static and dynamic [1, >= 0]
  T strap_stiffness{5e3};     ///< K of each strap at its pretension [N/m, > 0]
  T strap_exponent{50.0};     ///< b [1/m, > 0]
  T strap_pretension{30.0};   ///< S: force of each strap at p = q = 0 [N, >= 0]
  T strap_damping{0.2};       ///< g [s/m, >= 0]
  T strap_loosening{0.0};     ///< by which the straps grow longer per second of a trial [m/s]
  T axis_x{0.0};              ///< the machine's axis from the ankle [m]
  T axis_y{0.0};              ///< [m]
};

/// Motion of plate and foot.
template <class T>
struct FootPose {
  double plate_angle = 0;     ///< p [rad]
  double plate_velocity = 0;  ///< [rad/s]
  T ankle_angle{0.0};         ///< q [rad]
  T ankle_velocity{0.0};      ///< [rad/s]
  double since = 0;           ///< the trial began [s]
};

template <class T>
struct BoundaryLoad {
  T on_foot{0.0};         ///< moment about the ankle [N m]
  T on_plate{0.0};        ///< moment about the machine's axis [N m]
  T sole_on_plate{0.0};   ///< its part from the sole
  T normal{0.0};          ///< force of the plate on the sole, off the plate [N]
  T shear{0.0};           ///< force of the plate on the sole, towards the toes [N]
  T strap{0.0};           ///< forces of all straps [N]
  double stored = 0;      ///< energy in sole and straps, without derivatives [J]
  double dissipated = 0;  ///< power, without derivatives [W]
};

/// T is double or Dual.
template <class T>
[[nodiscard]] BoundaryLoad<T> BoundaryLoadAt(const FootGeometry& foot, const BoundaryLaw<T>& law,
                                             const FootPose<T>& pose) {
  BoundaryLoad<T> load;
  // In the frame of the plate: a point of the foot is at u from the ankle and at u - axis from the axis.
  const T between = pose.ankle_angle - pose.plate_angle;
  const Turn<T> turn{cos(between), sin(between)};
  const double c = std::cos(pose.plate_angle);
  const double s = std::sin(pose.plate_angle);
  const PlanarVector<T> axis{law.axis_x * c + law.axis_y * s, law.axis_y * c - law.axis_x * s};
  const T rate = pose.ankle_velocity - pose.plate_velocity;
  const auto velocity_of = [&](const PlanarVector<T>& u) {
    return PlanarVector<T>{-(rate * u.y) - pose.plate_velocity * axis.y,
                           rate * u.x + pose.plate_velocity * axis.x};
  };
  const auto apply = [&](const PlanarVector<T>& u, const PlanarVector<T>& force) {
    load.on_foot += Cross(u, force);
    load.on_plate -= Cross(PlanarVector<T>{u.x - axis.x, u.y - axis.y}, force);
  };

  // The foot was strapped on at p = 0, wherever the axis is.
  const T plate_height = law.sole_compression - foot.ankle_height - law.axis_y;
  const double height = foot.ankle_height;
  SoleMotion<T> sole;
  sole.depth = {plate_height + axis.y + height * turn.cosine, -turn.sine};
  sole.slip = {height * (rate * turn.cosine) - pose.plate_velocity * axis.y, -(rate * turn.sine)};
  sole.lifting = {height * (rate * turn.sine) + pose.plate_velocity * axis.x, rate * turn.cosine};
  const double strip = (foot.heel + foot.toe) / foot.strips * foot.width;
  const SoleForces<T> forces = SumOfStrips(
      foot,
      {law.sole_stiffness * strip, law.sole_dissipation, law.sole_exponent, law.bent_sole, law.friction},
      sole);
  load.normal = forces.normal;
  load.shear = forces.shear;
  load.stored = forces.stored;
  load.dissipated = forces.dissipated;
  load.on_foot = turn.cosine * (forces.normal_moment + height * forces.shear) +
                 turn.sine * (height * forces.normal - forces.shear_moment);
  load.on_plate = Cross(axis, PlanarVector<T>{forces.shear, forces.normal}) - load.on_foot;
  load.sole_on_plate = load.on_plate;

  for (const FootStrap& strap : foot.straps) {
    const PlanarVector<T> u = turn(PlanarVector<double>{strap.foot_x, strap.foot_y});
    const PlanarVector<T> along{strap.plate_x - law.axis_x + axis.x - u.x, plate_height + axis.y - u.y};
    const double rest = std::hypot(strap.plate_x - strap.foot_x, foot.ankle_height + strap.foot_y);
    const T length = sqrt(along.x * along.x + along.y * along.y);
    const T stretch = length - rest + law.sole_compression - law.strap_loosening * pose.since;
    const T growth = exp(law.strap_exponent * stretch) - 1.0;
    const T scale = law.strap_stiffness / law.strap_exponent;
    const T elastic = law.strap_pretension + scale * growth;
    if (!(Value(elastic) > 0)) {
      // Slack: it keeps the energy that it had when it became so.
      const double at_slack =
          std::log(1 - Value(law.strap_pretension) / Value(scale)) / Value(law.strap_exponent);
      load.stored += (Value(law.strap_pretension) - Value(scale)) * at_slack -
                     Value(law.strap_pretension) / Value(law.strap_exponent);
      continue;
    }
    const PlanarVector<T> direction{along.x / length, along.y / length};
    const PlanarVector<T> velocity = velocity_of(u);
    const T lengthening = -(direction.x * velocity.x + direction.y * velocity.y);
    const T damped = 1.0 + law.strap_damping * lengthening;
    const T pull = Value(damped) > 0 ? T(elastic * damped) : T(0.0);
    apply(u, {pull * direction.x, pull * direction.y});
    load.strap += pull;
    load.stored += (Value(law.strap_pretension) - Value(scale)) * Value(stretch) +
                   Value(scale) * Value(growth) / Value(law.strap_exponent);
    load.dissipated += (Value(pull) - Value(elastic)) * Value(lengthening);
  }
  return load;
}

}  // namespace sinew
