#include "problems/drive/laboratory/excitation.h"

#include <algorithm>
#include <cmath>

#include "base/constants.h"

namespace sinew {
namespace {

constexpr int kSines = 6;
constexpr double kSlowest = 0.1;  // [Hz]
constexpr double kFastest = 3;
constexpr double kFade = 0.5;  // [s]

std::size_t Samples(double duration, double rate) {
  return static_cast<std::size_t>(std::floor(duration * rate + 1e-9)) + 1;
}

// The swing grows about with the torque; a few corrections meet the angle within a tenth.
Status ScaleToSwing(const DriveTruth& nominal, double wanted, const std::vector<double>& shape,
                    DriveTrial& trial) {
  double factor = 0.2 * nominal[kGravityTorque] + 0.1;
  for (int round = 0; round < 12; ++round) {
    trial.command = shape;
    for (double& value : trial.command) value *= factor;
    SINEW_ASSIGN(const DriveRecord record, SimulateDrive(nominal, trial, 5e-3));
    const double reached = record.position.cwiseAbs().maxCoeff();
    if (std::abs(reached - wanted) < 0.1 * wanted) break;
    factor *= std::clamp(wanted / reached, 0.25, 2.0);
  }
  return {};
}

struct Span {
  double from, to;
};

// Six sines, faded in and out, not scaled yet.
std::vector<double> DrawShape(Span frequencies, double duration, double rate, Random& random) {
  std::vector<double> shape(Samples(duration, rate), 0.0);
  for (int s = 0; s < kSines; ++s) {
    const double frequency = frequencies.from * std::pow(frequencies.to / frequencies.from, random.Uniform());
    const double amplitude = random.Uniform(0.3, 1);
    const double phase = random.Uniform(0, 2 * kPi);
    for (std::size_t k = 0; k < shape.size(); ++k) {
      const double t = static_cast<double>(k) / rate;
      shape[k] += amplitude * std::sin(2 * kPi * frequency * t + phase);
    }
  }
  for (std::size_t k = 0; k < shape.size(); ++k) {
    const double edge = static_cast<double>(std::min(k, shape.size() - 1 - k)) / rate;
    if (edge < kFade) shape[k] *= 0.5 - 0.5 * std::cos(kPi * edge / kFade);
  }
  return shape;
}

Result<DriveTrial> DrawSines(const DriveTruth& nominal, Span frequencies, Span swing, double duration,
                             double rate, Random& random) {
  DriveTrial trial;
  trial.rate = rate;
  trial.initial_position = random.Uniform(-0.3, 0.3);
  const std::vector<double> shape = DrawShape(frequencies, duration, rate, random);
  SINEW_TRY(ScaleToSwing(nominal, random.Uniform(swing.from, swing.to), shape, trial));
  return trial;
}

// A trial whose command is followed by a position controller tuned for that joint.
DriveTrial Tracked(const DriveTruth& nominal, double rate) {
  DriveTrial trial;
  trial.rate = rate;
  trial.control = DriveControl::kTracking;
  const double bandwidth = 12;  // [rad/s]
  trial.controller.kp = nominal[kInertia] * bandwidth * bandwidth;
  trial.controller.kd = 1.6 * nominal[kInertia] * bandwidth;
  trial.controller.ki = 2 * trial.controller.kp;
  return trial;
}

// Angles over time made of moves with trapezoidal speed and rests.
class Moves {
 public:
  Moves(double begin, double duration, double rate)
      : rate_(rate), at_(begin), target_(Samples(duration, rate), begin) {}
  [[nodiscard]] bool done() const { return next_ >= target_.size(); }
  [[nodiscard]] double at() const { return at_; }
  [[nodiscard]] const std::vector<double>& target() const { return target_; }

  void To(double to, double speed, double acceleration, double rest) {
    const double distance = std::abs(to - at_);
    const double peak = std::min(speed, std::sqrt(distance * acceleration));
    const double ramp = peak / acceleration;
    const double move = distance / peak + ramp;
    for (; next_ < target_.size() && static_cast<double>(next_) / rate_ < t_ + move + rest; ++next_) {
      const double s = std::clamp(static_cast<double>(next_) / rate_ - t_, 0.0, move);
      const double left = move - s;
      double way = peak * (s - 0.5 * ramp);
      if (s < ramp) way = 0.5 * acceleration * s * s;
      if (left < ramp) way = distance - 0.5 * acceleration * left * left;
      target_[next_] = at_ + std::copysign(way, to - at_);
    }
    t_ += move + rest;
    at_ = to;
  }

 private:
  double rate_;
  double at_;
  double t_ = 0;          // [s] when the next move begins
  std::size_t next_ = 0;  // sample to fill
  std::vector<double> target_;
};

}  // namespace

Result<DriveTrial> DrawMultiSine(const DriveTruth& nominal, double duration, double rate, Random& random) {
  return DrawSines(nominal, {kSlowest, kFastest}, {0.6, 1.4}, duration, rate, random);
}

DriveTrial DrawOverTheTop(const DriveTruth& nominal, double duration, double rate, Random& random) {
  DriveTrial trial;
  trial.rate = rate;
  trial.initial_position = random.Uniform(-0.3, 0.3);
  trial.command = DrawShape({kSlowest, kFastest}, duration, rate, random);
  double largest = 0;
  for (const double value : trial.command) largest = std::max(largest, std::abs(value));
  const double scale = random.Uniform(2, 4) * nominal[kGravityTorque] / largest;
  for (double& value : trial.command) value *= scale;
  return trial;
}

DriveTrial DrawTrapezoid(const DriveTruth& nominal, double duration, double rate, Random& random) {
  DriveTrial trial = Tracked(nominal, rate);
  Moves moves(0, duration, rate);
  while (!moves.done()) {
    double to = random.Uniform(-1.2, 1.2);
    if (std::abs(to - moves.at()) < 0.4) to = moves.at() > 0 ? moves.at() - 0.8 : moves.at() + 0.8;
    const double speed = random.Uniform(0.5, 3);
    const double acceleration = random.Uniform(6, 20);
    const double rest = random.Uniform(0.1, 0.5);
    moves.To(to, speed, acceleration, rest);
  }
  trial.command = moves.target();
  return trial;
}

DriveTrial DrawCascaded(const DriveTruth& nominal, bool integral, double disturbance, double duration,
                        double rate, Random& random) {
  const double inertia = nominal[kInertia];
  DriveTrial trial = DrawTrapezoid(nominal, duration, rate, random);
  // It rests for a moment: what a controller does before its record begins is not known to who reads it.
  const std::size_t rest = std::min(Samples(0.1, rate), trial.command.size());
  trial.command.insert(trial.command.begin(), rest, trial.command.front());
  trial.command.resize(trial.command.size() - rest);
  trial.control = DriveControl::kCascade;
  trial.controller = {};
  trial.controller.control_period = 0.005;
  trial.controller.output_limit = 3 * nominal[kGravityTorque] + 30 * inertia;
  trial.cascade.position_gain = 10;
  trial.cascade.velocity_gain = 40 * inertia;
  trial.cascade.velocity_integral = integral ? 400 * inertia : 0;
  trial.cascade.velocity_filter = 0.005;
  trial.cascade.velocity_feedforward = 0.8;
  trial.cascade.acceleration_feedforward = 0.5 * inertia;
  if (disturbance > 0) {
    trial.disturbance = DrawShape({0.5, kFastest}, duration, rate, random);
    double largest = 0;
    for (const double value : trial.disturbance) largest = std::max(largest, std::abs(value));
    for (double& value : trial.disturbance) value *= disturbance / largest;
  }
  return trial;
}

DriveTrial DrawRest(double duration, double rate, Random& random) {
  DriveTrial trial;
  trial.rate = rate;
  const double angle = random.Uniform(0.1, 0.3);
  trial.initial_position = random.Uniform() < 0.5 ? -angle : angle;
  trial.command.assign(Samples(duration, rate), 0.0);
  return trial;
}

DriveTrial DrawCreep(const DriveTruth& nominal, double duration, double rate, Random& random) {
  constexpr double kSpeeds[] = {0.04, 0.1, 0.2, 0.4};  // [rad/s]
  constexpr double kAcceleration = 20;                 // [rad/s2]
  DriveTrial trial = Tracked(nominal, rate);
  trial.initial_position = random.Uniform(-0.8, 0.8);
  const double side = random.Uniform() < 0.5 ? -1 : 1;
  const double factor = random.Uniform(1, 1.25);
  Moves moves(trial.initial_position, duration, rate);
  const double time = duration / 8;  // of one way at one speed
  for (const double slow : kSpeeds) {
    const double speed = factor * slow;
    const double way = side * speed * (time - speed / kAcceleration);
    moves.To(trial.initial_position + way, speed, kAcceleration, 0);
    moves.To(trial.initial_position, speed, kAcceleration, 0);
  }
  trial.command = moves.target();
  return trial;
}

DriveTrial DrawHold(const DriveTruth& nominal, double duration, double rate, Random& random) {
  constexpr double kStairs[] = {-1.1, -0.5, 0.1, 0.8, 1.2, 0.5, -0.2, -0.8};  // [rad]
  constexpr double kSpeed = 3;
  constexpr double kAcceleration = 20;
  DriveTrial trial = Tracked(nominal, rate);
  const double side = random.Uniform() < 0.5 ? -1 : 1;
  Moves moves(0, duration, rate);
  for (const double stair : kStairs) {
    const double to = side * (stair + random.Uniform(-0.1, 0.1));
    const double distance = std::abs(to - moves.at());
    const double peak = std::min(kSpeed, std::sqrt(distance * kAcceleration));
    const double move = distance / peak + peak / kAcceleration;
    moves.To(to, kSpeed, kAcceleration, std::max(0.0, duration / 8 - move));
  }
  trial.command = moves.target();
  return trial;
}

Result<DriveTrial> DrawFast(const DriveTruth& nominal, double duration, double rate, Random& random) {
  return DrawSines(nominal, {0.5, kFastest}, {1.9, 2.2}, duration, rate, random);
}

Result<DriveTrial> DrawSharp(const DriveTruth& nominal, double duration, double rate, Random& random) {
  DriveTrial trial;
  trial.rate = rate;
  std::vector<double> shape(Samples(duration, rate), 0.0);
  for (std::size_t k = 0; k < shape.size();) {
    const double level = random.Uniform(-1, 1);
    const std::size_t end = k + Samples(random.Uniform(0.05, 0.4), rate);
    for (; k < std::min(end, shape.size()); ++k) shape[k] = level;
  }
  SINEW_TRY(ScaleToSwing(nominal, random.Uniform(0.6, 1.2), shape, trial));
  return trial;
}

DriveTrial BackAndForth(double first, double second, double duration, double rate) {
  constexpr double kUpper = 15 * kDegree;
  constexpr double kLower = -20 * kDegree;
  DriveTrial trial;
  trial.rate = rate;
  trial.control = DriveControl::kPidSpeed;
  trial.command.assign(Samples(duration, rate), 0.0);  // the first sample is rest
  double position = 0;
  double direction = 1;
  for (std::size_t k = 1; k < trial.command.size(); ++k) {
    const double speed = static_cast<double>(k) / rate <= 0.5 * duration ? first : second;
    if (position >= kUpper) direction = -1;
    if (position <= kLower) direction = 1;
    trial.command[k] = direction * speed;
    position += trial.command[k] / rate;
  }
  return trial;
}

}  // namespace sinew
