#include "problems/drive/data/starts.h"

#include <algorithm>
#include <cmath>

#include "base/decompositions.h"
#include "models/drive/control_law.h"

namespace sinew {
namespace {

double Interpolate(const std::vector<double>& time, const std::vector<double>& values, double t) {
  if (time.empty() || t <= time.front()) return values.front();
  if (t >= time.back()) return values.back();
  const auto i = static_cast<std::size_t>(std::upper_bound(time.begin(), time.end(), t) - time.begin());
  const double part = (t - time[i - 1]) / (time[i] - time[i - 1]);
  return values[i - 1] + part * (values[i] - values[i - 1]);
}

// Integrals over one window of everything the equation of motion is made of.
struct Row {
  double command = 0;
  double acceleration = 0;
  double speed = 0;
  double gravity = 0;    // sin q
  double direction = 0;  // of motion, from -1 to 1
  double position = 0;
  double one = 0;
};

// @param slow speed [rad/s] below which the direction is uncertain
Row Window(const DriveMotion& motion, const std::vector<double>& command, std::size_t first, std::size_t last,
           double slow) {
  const double middle = 0.5 * (motion.time[first] + motion.time[last]);
  const double half = 0.5 * (motion.time[last] - motion.time[first]);
  Row row;
  for (std::size_t i = first; i <= last; ++i) {
    const double before = i == first ? motion.time[i] : motion.time[i - 1];
    const double after = i == last ? motion.time[i] : motion.time[i + 1];
    const double dt = 0.5 * (after - before);
    const double s = std::clamp((motion.time[i] - middle) / half, -1.0, 1.0);
    const double c = 1 - s * s;
    const double window = c * c * c * c * c;
    const double slope = -10 * s * c * c * c * c / half;
    const double bend = (-10 * c + 80 * s * s) * c * c * c / (half * half);
    row.command += dt * window * command[i];
    row.gravity += dt * window * std::sin(motion.position[i]);
    row.direction += dt * window * std::tanh(motion.speed[i] / slow);
    row.position += dt * window * motion.position[i];
    row.one += dt * window;
    if (motion.speed_measured) {
      row.speed += dt * window * motion.speed[i];
      row.acceleration -= dt * slope * motion.speed[i];
    } else {
      row.speed -= dt * slope * motion.position[i];
      row.acceleration += dt * bend * motion.position[i];
    }
  }
  return row;
}

// Whether the motor is on at every one of these samples.
bool IsOn(const DriveMotion& motion, std::size_t first, std::size_t last) {
  for (std::size_t i = first; i <= last; ++i) {
    if (!motion.run->OnAt(motion.time[i])) return false;
  }
  return true;
}

// @param electric damping by the motor is part of the equation: only where it is on
std::vector<Row> Rows(const DriveCommand& command, bool electric, const std::vector<DriveMotion>& motions,
                      double slow) {
  constexpr double kWindow = 0.4;  // [s] long against sampling and noise, short against the motion
  constexpr std::size_t kMinimum = 12;
  std::vector<Row> rows;
  for (const DriveMotion& motion : motions) {
    const std::vector<double> torque = ReplayCommand(command, motion);
    std::size_t last = 0;
    for (std::size_t first = 0; first < motion.time.size();) {
      while (last < motion.time.size() &&
             (motion.time[last] < motion.time[first] + kWindow || last < first + kMinimum)) {
        ++last;
      }
      if (last >= motion.time.size()) break;
      if (!electric || IsOn(motion, first, last)) rows.push_back(Window(motion, torque, first, last, slow));
      first += std::max<std::size_t>((last - first) / 4, 1);
    }
  }
  return rows;
}

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

double LocalSlope(const std::vector<double>& time, const std::vector<double>& values, std::size_t i,
                  double reach) {
  std::size_t first = i;
  std::size_t last = i;
  while (first > 0 && (time[i] - time[first - 1] <= reach || i - first < 2)) --first;
  while (last + 1 < time.size() && (time[last + 1] - time[i] <= reach || last - i < 2)) ++last;
  if (last == first) return 0;
  double mean_time = 0;
  double mean = 0;
  const auto n = static_cast<double>(last - first + 1);
  for (std::size_t k = first; k <= last; ++k) {
    mean_time += (time[k] - time[i]) / n;
    mean += (values[k] - values[i]) / n;
  }
  double up = 0;
  double down = 0;
  for (std::size_t k = first; k <= last; ++k) {
    const double t = time[k] - time[i] - mean_time;
    up += t * (values[k] - values[i] - mean);
    down += t * t;
  }
  return up / down;
}

std::vector<double> ReplayCommand(const DriveCommand& command, const DriveMotion& motion) {
  const DriveRun& run = *motion.run;
  const DriveSeries& voltage = run.signals[kSupplyVoltage];
  const auto supply = [&](double t) { return Interpolate(voltage.time, voltage.values, t); };
  const auto recorded = [&](double t) {
    if (!run.held) return Interpolate(run.input_time, run.input, t);
    const auto after = std::upper_bound(run.input_time.begin(), run.input_time.end(), t);
    return run
        .input[static_cast<std::size_t>(std::max<std::ptrdiff_t>(after - run.input_time.begin() - 1, 0))];
  };
  std::vector<double> replayed;
  if (command.sampled()) {
    DriveControlLaw<double> law(command.controller, run.gains, 0);
    const bool of_speed = command.controller == DriveControllerKind::kPidSpeed;
    double output = 0;
    int tick = 0;
    for (const double t : motion.time) {
      for (; tick * run.gains.control_period <= t; ++tick) {
        const double now = tick * run.gains.control_period;
        output = law.Output(
            {recorded(now), Interpolate(motion.time, of_speed ? motion.speed : motion.position, now),
             motion.speed.front(),
             run.disturbance.values.empty() ? 0
                                            : Interpolate(run.disturbance.time, run.disturbance.values, now),
             run.OnAt(now)});
      }
      replayed.push_back(run.OnAt(t) ? output : 0);
    }
    return replayed;
  }
  for (std::size_t i = 0; i < motion.time.size(); ++i) {
    const double t = motion.time[i];
    double u = recorded(t);
    if (command.input == DriveInput::kDuty) u *= supply(t);
    if (command.input == DriveInput::kReference) {
      const double duty = run.gains.servo_error_gain * run.gains.kp * (u - motion.position[i]);
      u = std::clamp(duty, -1.0, 1.0) * supply(t);
    }
    replayed.push_back(run.OnAt(t) ? u : 0);
  }
  return replayed;
}

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
  const std::vector<Row> rows = Rows(command, joint.electric, motions, kSlow * most_speed);
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
  const Vector acceleration = column([](const Row& row) { return row.acceleration; });
  const Vector speed = column([](const Row& row) { return row.speed; });
  const Vector gravity = column([](const Row& row) { return row.gravity; });
  const Vector u = column([](const Row& row) { return row.command; });
  const Vector one = column([](const Row& row) { return row.one; });
  const Vector direction = column([](const Row& row) { return row.direction; });
  const Vector position = column([](const Row& row) { return row.position; });
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
