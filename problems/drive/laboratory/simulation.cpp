#include "problems/drive/laboratory/simulation.h"

#include <algorithm>
#include <cmath>

#include "base/constants.h"

namespace sinew {
namespace {

constexpr double kTail = 0.2;     // [s] the motion goes on after the last sample
constexpr double kRoom = 293.15;  // [K]

double Bell(double x, double width) {
  const double z = x / width;
  return std::exp(-z * z);
}

// Samples, straight between them and constant beyond.
class Line {
 public:
  Line(std::vector<double> values, double rate) : values_(std::move(values)), rate_(rate) {}
  [[nodiscard]] double At(double t) const {
    const double x = t * rate_;
    if (x <= 0) return values_.front();
    if (x >= static_cast<double>(values_.size() - 1)) return values_.back();
    const auto i = static_cast<std::size_t>(x);
    return values_[i] + (x - static_cast<double>(i)) * (values_[i + 1] - values_[i]);
  }
  [[nodiscard]] double Held(double t) const {
    const double x = std::clamp(t * rate_ + 1e-9, 0.0, static_cast<double>(values_.size() - 1));
    return values_[static_cast<std::size_t>(x)];
  }
  std::vector<double>& values() { return values_; }

 private:
  std::vector<double> values_;
  double rate_;
};

// What an instrument makes of a fine signal x that starts at time t0 with step h.
Vector Record(const std::vector<double>& x, double t0, double h, Eigen::Index count, double rate,
              double time_offset, double clock_rate, double low_pass) {
  std::vector<double> smoothed;
  if (low_pass > 0) {  // exact for a signal that is straight between its fine samples
    smoothed = x;
    const double decay = std::exp(-h / low_pass);
    double error = 0;
    for (std::size_t i = 1; i < x.size(); ++i) {
      error = decay * error - low_pass / h * (1 - decay) * (x[i] - x[i - 1]);
      smoothed[i] += error;
    }
  }
  const std::vector<double>& signal = low_pass > 0 ? smoothed : x;
  Vector recorded(count);
  for (Eigen::Index k = 0; k < count; ++k) {
    const double t = static_cast<double>(k) / rate * (1 + clock_rate) - time_offset;
    const double at = std::clamp((t - t0) / h, 0.0, static_cast<double>(x.size() - 1));
    const auto i = std::min(static_cast<std::size_t>(at + 1e-9), x.size() - 2);
    recorded[k] = signal[i] + (at - static_cast<double>(i)) * (signal[i + 1] - signal[i]);
  }
  return recorded;
}

void Distort(double gain, double offset, double drift, double rate, Vector& reading) {
  const double middle = 0.5 * static_cast<double>(reading.size() - 1);
  for (Eigen::Index k = 0; k < reading.size(); ++k) {
    reading[k] = gain * reading[k] + offset + drift * (static_cast<double>(k) - middle) / rate;
  }
}

// The joint and everything that pushes it.
class Bench {
 public:
  Bench(const DriveTruth& truth, const DriveTrial& trial, double h)
      : p_(truth),
        trial_(trial),
        h_(h),
        q_(trial.initial_position),
        v_(trial.initial_speed),
        v_before_(v_),
        play_(q_),
        speeds_(static_cast<std::size_t>(std::floor(truth[kSensingDelay] / h)) + 2, v_),
        positions_(speeds_.size(), q_),
        wanted_before_(trial.command.front()),
        has_friction_(truth[kCoulombTorque] > 0 || truth[kForwardFriction] > 0 ||
                      truth[kBackwardFriction] > 0 || truth[kStribeckTorque] > 0 || truth[kWearRate] > 0 ||
                      truth[kTightSpotTorque] > 0),
        has_load_friction_(truth[kLoadFriction] > 0 || truth[kMotorLoadFriction] > 0 ||
                           truth[kExternalLoadFriction] > 0 || truth[kStribeckLoad] > 0 ||
                           truth[kQuadraticLoad] > 0),
        has_further_(truth[kSpring] != 0 || truth[kImbalance] != 0 || truth[kCoggingCos] != 0 ||
                     truth[kCoggingSin] != 0 || truth[kCubicStiffness] != 0 || truth[kStopStiffness] != 0 ||
                     truth[kHumTorque] != 0 || truth[kBumpTorque] != 0) {}

  // One step from t under a command u (before the drive's own faults), or without a motor.
  void Step(double t, double u, bool on) {
    const double middle = t + 0.5 * h_;
    const double q = q_ + 0.5 * h_ * v_;
    const double speed = v_ + 0.5 * (v_ - v_before_);  // about the middle of the step
    const double left = p_[kLostLoad] > 0 && middle > p_[kLostTime] ? 1 - p_[kLostLoad] : 1;
    const double gravity = (p_[kGravityTorque] * left + p_[kShiftRate] * middle) * std::sin(q);
    torque_ = on ? Actuate(u, speed, middle) : 0;
    double force = torque_ - gravity + p_[kOffsetTorque];
    if (has_further_) force += Further(q, middle);
    if (p_[kHysteresisTorque] > 0) force -= Hysteresis();
    double viscous = p_[kViscousFriction];
    if (p_[kFrictionTemperature] != 0)
      viscous *= std::exp(p_[kFrictionTemperature] * (trial_.warming.At(middle) - kRoom));
    const double damping = viscous + p_[kDampingRate] * std::max(0.0, middle) + p_[kDrag] * std::abs(speed) +
                           p_[kCubicDrag] * speed * speed +
                           (speed > 0 ? p_[kViscousAsymmetry] : -p_[kViscousAsymmetry]);
    const double mass = p_[kInertia] * left;
    const double inverse = 1 / (mass + 0.5 * h_ * damping);
    double next = ((mass - 0.5 * h_ * damping) * v_ + h_ * force) * inverse;
    if (has_friction_ || has_load_friction_) {
      const double dry = DryFriction(q, speed, gravity);
      const double forward = h_ * (dry + p_[kForwardFriction]) * inverse;
      const double backward = h_ * (dry + p_[kBackwardFriction]) * inverse;
      next = next > forward ? next - forward : next < -backward ? next + backward : 0;
    }
    v_before_ = v_;
    v_ = next;
    q_ = q + 0.5 * h_ * v_;
    travelled_ += h_ * std::abs(v_);
    speeds_[++steps_ % speeds_.size()] = v_;
    positions_[steps_ % speeds_.size()] = q_;
  }

  // What the position sensor faces.
  double Reading() {
    double seen = q_;
    if (p_[kBacklash] > 0) {
      play_ = std::clamp(play_, q_ - 0.5 * p_[kBacklash], q_ + 0.5 * p_[kBacklash]);
      seen = play_;
    }
    seen += p_[kCompliance] * torque_;
    if (p_[kEccentricity] > 0) seen += p_[kEccentricity] * std::sin(2 * q_ + p_[kEccentricityPhase]);
    return seen;
  }

  // The known controller's output at a tick. A motor that is off resets the integral.
  double PidSpeed(double reference, bool on) {
    const DriveController& c = trial_.controller;
    const double error = reference - Ago(speeds_, p_[kSensingDelay]);
    const double slope = ticked_ ? (error - error_) / c.control_period : 0;
    ticked_ = true;
    error_ = error;
    const double integral = integral_ + error * c.control_period;
    const double output = c.kp * error + c.ki * integral + c.kd * slope;
    if (!on) integral_ = 0;
    if (on && (std::abs(output) <= c.output_limit || output * error < 0)) integral_ = integral;
    return std::clamp(output, -c.output_limit, c.output_limit);
  }

  // That of the cascade, with what is added to it.
  double Cascade(double reference, double disturbance, bool on) {
    const DriveCascade& c = trial_.cascade;
    const double period = trial_.controller.control_period;
    const double limit = trial_.controller.output_limit;
    const double seen = Ago(positions_, p_[kSensingDelay]);
    if (!ticked_) estimate_ = v_;
    if (ticked_)
      estimate_ = (c.velocity_filter * estimate_ + (seen - seen_before_)) / (c.velocity_filter + period);
    const double pace = (reference - wanted_before_) / period;
    double speed = c.position_gain * (reference - seen) + c.velocity_feedforward * pace;
    if (c.speed_limit > 0) speed = std::clamp(speed, -c.speed_limit, c.speed_limit);
    const double error = speed - estimate_;
    const double sum = integral_ + error * period;
    const double push = c.acceleration_feedforward * (pace - pace_before_) / period;
    const double output = c.velocity_gain * error + c.velocity_integral * sum + push + disturbance;
    ticked_ = true;
    seen_before_ = seen;
    wanted_before_ = reference;
    pace_before_ = pace;
    if (!on) integral_ = 0;
    if (on && (!(limit > 0) || std::abs(output) <= limit || output * error < 0)) integral_ = sum;
    return limit > 0 ? std::clamp(output, -limit, limit) : output;
  }

  // The laboratory's own position controller: PD with a slow integral.
  double Tracking(double target, double period) {
    const DriveController& c = trial_.controller;
    const double error = target - q_;
    integral_ += error * period;
    return c.kp * error + c.ki * integral_ - c.kd * v_;
  }

  [[nodiscard]] double q() const { return q_; }
  [[nodiscard]] double v() const { return v_; }
  [[nodiscard]] double torque() const { return torque_; }

 private:
  double Actuate(double u, double speed, double t) const {
    double torque = u;
    if (p_[kDeadZone] > 0) torque = std::copysign(std::max(0.0, std::abs(u) - p_[kDeadZone]), u);
    if (p_[kCommandStep] > 0) torque = std::round(torque / p_[kCommandStep]) * p_[kCommandStep];
    if (p_[kCompression] > 0) torque *= 1 - p_[kCompression] * std::abs(u) / trial_.command_scale;
    if (p_[kThermalRate] != 0) torque *= 1 - p_[kThermalRate] * std::max(0.0, t);
    if (p_[kWarmUpGain] != 0) torque *= 1 - p_[kWarmUpGain] * std::expm1(-std::max(0.0, t) / p_[kWarmUpTime]);
    if (p_[kSessionRate] != 0) torque *= 1 + p_[kSessionRate] * (trial_.session + std::max(0.0, t));
    if (p_[kInverseTorqueLimit] > 0) {
      torque = std::clamp(torque, -1 / p_[kInverseTorqueLimit], 1 / p_[kInverseTorqueLimit]);
    }
    if (p_[kInverseSpeedLimit] > 0 && torque * speed > 0) {
      torque *= std::clamp((1 - std::abs(speed) * p_[kInverseSpeedLimit]) / 0.1, 0.0, 1.0);
    }
    return torque;
  }

  double Further(double q, double t) const {
    double force = -p_[kSpring] * q - p_[kImbalance] * std::cos(q);
    force -= p_[kCubicStiffness] * q * q * q;
    force -= p_[kStopStiffness] * std::max(0.0, q - p_[kStopPosition]);
    if (p_[kCoggingCos] != 0 || p_[kCoggingSin] != 0) {
      const double angle = 2 * kPi * q / p_[kCoggingPeriod];
      force += p_[kCoggingCos] * std::cos(angle) + p_[kCoggingSin] * std::sin(angle);
    }
    if (p_[kHumTorque] != 0)
      force += p_[kHumTorque] * std::sin(2 * kPi * p_[kHumFrequency] * t + p_[kHumPhase]);
    if (p_[kBumpTorque] != 0) force += p_[kBumpTorque] * Bell(q - p_[kBumpPosition], p_[kBumpWidth]);
    return force;
  }

  // Dahl 1968: ds/dq = (1 - s sign v) / width, torque = hysteresis_torque s; exact for constant speed.
  double Hysteresis() {
    const double travel = std::abs(v_) * h_ / p_[kHysteresisWidth];
    const double end = v_ > 0 ? 1 : -1;
    dahl_ = end + (dahl_ - end) * std::exp(-travel);
    return p_[kHysteresisTorque] * dahl_;
  }

  double DryFriction(double q, double speed, double gravity) const {
    double level = p_[kCoulombTorque];
    if (p_[kStribeckTorque] > 0) level += p_[kStribeckTorque] * Bell(speed, p_[kStribeckVelocity]);
    if (p_[kWearRate] > 0) level += p_[kWearRate] * travelled_;
    if (p_[kTightSpotTorque] > 0) {
      level += p_[kTightSpotTorque] * Bell(q - p_[kTightSpotPosition], p_[kTightSpotWidth]);
    }
    if (has_load_friction_) {
      const double load = 0.5 * std::abs(torque_ + gravity);
      double factor = p_[kLoadFriction] + p_[kQuadraticLoad] * load;
      if (p_[kStribeckLoad] > 0) {
        factor += p_[kStribeckLoad] * Bell(speed, p_[kStribeckLoadVelocity]);
      }
      level += factor * load + p_[kMotorLoadFriction] * std::abs(torque_) +
               p_[kExternalLoadFriction] * std::abs(gravity);
    }
    return level;
  }

  [[nodiscard]] double Ago(const std::vector<double>& ring, double delay) const {
    const double back = delay / h_;
    const auto whole = std::min(static_cast<std::size_t>(back), ring.size() - 2);
    const double rest = back - static_cast<double>(whole);
    const std::size_t at = steps_ + ring.size() - whole;
    const double newer = ring[at % ring.size()];
    return newer + rest * (ring[(at - 1) % ring.size()] - newer);
  }

  const DriveTruth& p_;
  const DriveTrial& trial_;
  double h_;
  double q_;
  double v_;
  double v_before_;
  double play_;
  double torque_ = 0;
  double travelled_ = 0;
  double dahl_ = 0;
  double integral_ = 0;
  double error_ = 0;
  bool ticked_ = false;
  std::size_t steps_ = 0;
  std::vector<double> speeds_;     // the last ones, as a ring
  std::vector<double> positions_;  // likewise
  double wanted_before_;           // of the cascade: the last tick's reference, its slope, what was seen, and
  double pace_before_ = 0;         // the estimated speed
  double seen_before_ = 0;
  double estimate_ = 0;
  bool has_friction_;
  bool has_load_friction_;
  bool has_further_;
};

}  // namespace

double DriveWarming::At(double t) const {
  return kRoom + rise * (1 - std::exp(-(worked + t) / time_constant));
}

Result<DriveRecord> SimulateDrive(const DriveTruth& truth, const DriveTrial& trial, double step) {
  const auto count = static_cast<Eigen::Index>(trial.command.size());
  if (count < 2) return Fail("the laboratory needs at least two samples per trial, got {}", count);
  const int per_sample = std::max(1, static_cast<int>(std::ceil(1 / (trial.rate * step) - 1e-9)));
  const double h = 1 / (trial.rate * per_sample);
  const auto before = static_cast<Eigen::Index>(std::ceil(kDriveLead * trial.rate));
  const auto after = static_cast<Eigen::Index>(std::ceil(kTail * trial.rate));
  const auto steps = static_cast<std::size_t>((before + count - 1 + after) * per_sample);
  const double t0 = -static_cast<double>(before) / trial.rate;

  Bench bench(truth, trial, h);
  const bool tracking = trial.control == DriveControl::kTracking;
  const bool cascade = trial.control == DriveControl::kCascade;
  const bool pid = trial.control == DriveControl::kPidSpeed || cascade;  // sampled
  const auto series = [&](const std::vector<double>& values, double otherwise) {
    return Line(values.empty() ? std::vector<double>(trial.command.size(), otherwise) : values, trial.rate);
  };
  const Line disturbance = series(trial.disturbance, 0);
  const Line motor = series(trial.motor_on, 1);
  // The command itself, or the torque that the tracking controller commands: what it computes at a sample is
  // reached, on a straight line, at the next.
  Line command(tracking ? std::vector<double>(trial.command.size(), 0.0) : trial.command, trial.rate);
  const double period = pid ? trial.controller.control_period : 0;
  const auto ticks = pid ? std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(period / h))) : 1;
  double pid_torque = 0;
  // What the controller commanded at the last steps: it acts late.
  std::vector<double> commanded(static_cast<std::size_t>(std::lround(truth[kActuationDelay] / h)) + 1, 0.0);

  std::vector<double> seen(steps + 1);
  seen[0] = bench.Reading();
  DriveRecord record{Vector(count), Vector(count), Vector(count), Vector(count), Vector(count)};
  for (Eigen::Index k = 0; k < count; ++k)
    record.temperature[k] = trial.warming.At(static_cast<double>(k) / trial.rate);
  for (std::size_t i = 0; i < steps; ++i) {
    const double t = t0 + static_cast<double>(i) * h;
    if (i % static_cast<std::size_t>(per_sample) == 0) {
      const auto k = static_cast<Eigen::Index>(i) / per_sample - before;
      if (k >= 0 && k < count) {
        if (tracking && k + 1 < count) {
          command.values()[static_cast<std::size_t>(k + 1)] =
              bench.Tracking(trial.command[static_cast<std::size_t>(k)], 1 / trial.rate);
        }
        record.speed[k] = bench.v();
        record.torque[k] = bench.torque();
      }
    }
    const double at = (pid ? t : t + 0.5 * h) - truth[kCommandDelay];
    double u = command.At(at);
    if (truth[kHoldFraction] > 0) u += truth[kHoldFraction] * (command.Held(at) - u);
    if (pid) {
      const bool on = motor.Held(t) > 0;
      if (i % ticks == 0)
        pid_torque = cascade ? bench.Cascade(u, disturbance.At(t), on) : bench.PidSpeed(u, on);
      commanded[i % commanded.size()] = pid_torque;
      u = commanded[(i + 1) % commanded.size()];
    }
    bench.Step(t, u, motor.Held(t + 0.5 * h) > 0);
    seen[i + 1] = bench.Reading();
  }
  record.position = Record(seen, t0, h, count, trial.rate, truth[kPositionTimeOffset], truth[kClockRate],
                           truth[kPositionLowPass]);
  Distort(truth[kPositionGain], truth[kPositionOffset], truth[kPositionDrift], trial.rate, record.position);

  const bool plain_input = truth[kInputTimeOffset] == 0 && truth[kInputLowPass] == 0;
  if (plain_input) {
    record.input = Eigen::Map<const Vector>(command.values().data(), count);
  } else {
    std::vector<double> fine(steps + 1);
    for (std::size_t i = 0; i <= steps; ++i) fine[i] = command.At(t0 + static_cast<double>(i) * h);
    record.input = Record(fine, t0, h, count, trial.rate, truth[kInputTimeOffset], 0, truth[kInputLowPass]);
  }
  Distort(truth[kInputGain], truth[kInputOffset], truth[kInputDrift], trial.rate, record.input);
  if (!record.position.allFinite() || !record.input.allFinite()) {
    return Fail("the simulated drive does not stay finite with these parameters");
  }
  return record;
}

void ReadPosition(const DriveTruth& truth, Vector& position) {
  if (truth[kPositionSaturation] > 0) {
    const double limit = 1 / truth[kPositionSaturation];
    position = position.cwiseMax(-limit).cwiseMin(limit);
  }
  if (truth[kPositionQuantisation] > 0) {
    const double step = truth[kPositionQuantisation];
    position = (position / step).array().round() * step;
  }
}

}  // namespace sinew
