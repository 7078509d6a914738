#include "problems/drive/data/starts.h"

#include <algorithm>
#include <cmath>

#include "base/decompositions.h"
#include "problems/drive/data/weak_form.h"

namespace sinew {
namespace {

// Least squares of sum_k x_k column_k = right; nothing if the columns are rank deficient or explain nearly
// nothing: where they are all noise, the coefficients are far too small (attenuation: Fuller 1987,
// Measurement error models).
std::optional<Vector> Solve(const std::vector<Vector>& of, const Vector& right) {
  constexpr double kLeastExplained = 0.1;
  Matrix columns(right.size(), static_cast<Eigen::Index>(of.size()));
  for (std::size_t k = 0; k < of.size(); ++k) columns.col(static_cast<Eigen::Index>(k)) = of[k];
  if (columns.rows() < 2 * columns.cols()) return {};
  const Vector scale = columns.colwise().norm();
  if (!(scale.minCoeff() > 0)) return {};
  const Matrix unit = columns * scale.cwiseInverse().asDiagonal();
  const Eigen::ColPivHouseholderQR<Matrix> qr(unit);
  if (qr.rank() < columns.cols()) return {};
  const Vector x = qr.solve(right).cwiseQuotient(scale);
  if (!x.allFinite()) return {};
  if ((right - columns * x).squaredNorm() > (1 - kLeastExplained) * right.squaredNorm()) return {};
  return x;
}

}  // namespace

DriveStarts EstimateDriveStarts(const DriveJoint& joint, const DriveCommand& command,
                                const std::vector<DriveMotion>& motions,
                                const std::array<std::optional<double>, kDriveSlots>& fixed) {
  constexpr double kTypicalTime = 0.2;       // [s] to reach the highest speed with the largest torque
  constexpr double kLeastOwnInertia = 0.01;  // of that of a known load
  double most_command = 0;
  double most_speed = 0;
  for (const DriveMotion& motion : motions) {
    for (const double u : ReplayCommand(command, motion)) most_command = std::max(most_command, std::abs(u));
    for (const double v : motion.speed) most_speed = std::max(most_speed, std::abs(v));
  }
  if (most_command == 0) most_command = 1;
  if (most_speed == 0) most_speed = 1;
  const auto known = [&](int slot) { return fixed[static_cast<std::size_t>(slot)]; };

  DriveStarts starts{};
  starts[kDriveGain] = 1;
  starts[kTorqueConstant] =
      joint.electric ? known(kTorqueConstant).value_or(0.5 * most_command / most_speed) : 1;
  starts[kResistance] = known(kResistance).value_or(1);
  double torque = most_command;
  if (joint.electric) torque *= starts[kTorqueConstant] / starts[kResistance];
  starts[kInertia] = torque * kTypicalTime / most_speed;
  starts[kViscousFriction] = 0.1 * torque / most_speed;
  starts[kGravityTorque] = 0;

  constexpr double kSlow = 0.05;  // of the highest speed
  const std::vector<WeakRow> rows = WeakRows(command, joint.electric, motions, kSlow * most_speed);
  const auto n = static_cast<Eigen::Index>(rows.size());
  const bool hangs = joint.rotary && !joint.load_known;
  // Unknowns: with a known load the scale is that of the load; without, that of the command.
  std::vector<Vector> columns;
  Vector right(n);
  const auto column = [&](auto&& of) {
    Vector c(n);
    for (Eigen::Index i = 0; i < n; ++i) c[i] = of(rows[static_cast<std::size_t>(i)]);
    return c;
  };
  const Vector acceleration = column([](const WeakRow& row) { return row.acceleration; });
  const Vector speed = column([](const WeakRow& row) { return row.speed; });
  const Vector gravity = column([](const WeakRow& row) { return row.gravity; });
  const Vector u = column([](const WeakRow& row) { return row.command; });
  const Vector one = column([](const WeakRow& row) { return row.one; });
  const Vector direction = column([](const WeakRow& row) { return row.direction; });
  const Vector position = column([](const WeakRow& row) { return row.position; });
  if (joint.load_known) {
    // gain u - damping v - inertia a = load inertia a + load gravity
    columns = {acceleration, speed, -u};
    right = -joint.load_inertia * acceleration - joint.load_gravity * gravity;
  } else {
    // u / 1 = inertia a + damping v + gravity, each per gain
    columns = {acceleration, speed};
    if (hangs) columns.push_back(gravity);
    right = u - joint.incline_force * one;
  }
  const auto solution = Solve(columns, right);
  if (!solution) return starts;
  Vector x = *solution;

  if (joint.load_known) {
    const double gain = x[2];  // torque per command
    if (!(gain > 0)) return starts;
    // What a spring, an offset or dry friction take of the torque may leave nothing for the joint's own
    // inertia.
    const double least = kLeastOwnInertia * joint.load_inertia;
    if (x[0] < least) {
      columns.insert(columns.end(), {direction, one, position});
      if (const auto beside = Solve(columns, right); beside && (*beside)[2] > 0) x[0] = (*beside)[0];
    }
    starts[kInertia] = std::max(x[0], least);
    if (!joint.electric) {
      starts[kDriveGain] = gain;
      starts[kViscousFriction] = std::max(x[1], 0.0);
      return starts;
    }
    // Damping is that of the friction and of the back-emf; half each, unless something is known.
    const double damping = std::max(x[1], 1e-3 * gain * most_command / most_speed);
    const double per_speed = known(kViscousFriction).value_or(0.5 * damping);
    const double constant = known(kTorqueConstant)
                                .value_or(known(kResistance) ? gain * *known(kResistance) / joint.gear_ratio
                                                             : std::max(damping - per_speed, 0.1 * damping) /
                                                                   (gain * joint.gear_ratio));
    starts[kTorqueConstant] = constant;
    starts[kResistance] = known(kResistance).value_or(joint.gear_ratio * constant / gain);
    starts[kViscousFriction] = per_speed;
    return starts;
  }
  // Where dry friction takes most of the torque, the inertia without it is wrong by a factor of ten; what the
  // other parameters are without it is what a model without it needs.
  columns.push_back(direction);
  columns.push_back(one);
  if (const auto beside_friction = Solve(columns, right); beside_friction && (*beside_friction)[0] > 0)
    x[0] = (*beside_friction)[0];
  if (!(x[0] > 0)) return starts;
  if (!joint.electric) {
    starts[kInertia] = x[0];
    starts[kViscousFriction] = std::max(x[1], 0.0);
    if (hangs) starts[kGravityTorque] = x[2];
    return starts;
  }
  // Volts per everything; the torque scale is that of the constants, or such that half the damping is the
  // motor's.
  const double damping = std::max(x[1], 1e-3 * most_command / most_speed);
  const double resistance = starts[kResistance];
  const double constant = known(kTorqueConstant).value_or(0.5 * damping / joint.gear_ratio);
  const double gain = joint.gear_ratio * constant / resistance;
  starts[kTorqueConstant] = constant;
  starts[kInertia] = gain * x[0];
  starts[kViscousFriction] = std::max(gain * (damping - joint.gear_ratio * constant), 0.0);
  if (hangs) starts[kGravityTorque] = gain * x[2];
  return starts;
}

}  // namespace sinew
