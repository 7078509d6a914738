#include "problems/drive/drive_excitation.h"

#include <algorithm>
#include <cmath>

namespace sinew {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kDegree = kPi / 180;
constexpr int kSines = 6;
constexpr double kSlowest = 0.1;  // [Hz]
constexpr double kFastest = 3;
constexpr double kFade = 0.5;  // [s]

std::size_t Samples(double duration, double rate) {
  return static_cast<std::size_t>(std::floor(duration * rate + 1e-9)) + 1;
}

}  // namespace

Result<DriveTrial> DrawMultiSine(const DriveTruth& nominal, double duration, double rate, Random& random) {
  DriveTrial trial;
  trial.rate = rate;
  trial.initial_position = random.Uniform(-0.3, 0.3);
  std::vector<double> shape(Samples(duration, rate), 0.0);
  for (int s = 0; s < kSines; ++s) {
    const double frequency = kSlowest * std::pow(kFastest / kSlowest, random.Uniform());
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
  // The swing grows about with the torque; a few corrections meet the angle within a tenth.
  const double wanted = random.Uniform(0.6, 1.4);
  double factor = 0.2 * nominal.gravity_torque + 0.1;
  for (int round = 0; round < 12; ++round) {
    trial.command = shape;
    for (double& value : trial.command) value *= factor;
    SINEW_ASSIGN(const DriveRecord record, SimulateDrive(nominal, trial, 5e-3));
    const double reached = record.position.cwiseAbs().maxCoeff();
    if (std::abs(reached - wanted) < 0.1 * wanted) break;
    factor *= std::clamp(wanted / reached, 0.25, 2.0);
  }
  return trial;
}

DriveTrial DrawTrapezoid(const DriveTruth& nominal, double duration, double rate, Random& random) {
  DriveTrial trial;
  trial.rate = rate;
  trial.control = DriveControl::kTracking;
  const double bandwidth = 12;  // [rad/s]
  trial.controller.kp = nominal.inertia * bandwidth * bandwidth;
  trial.controller.kd = 1.6 * nominal.inertia * bandwidth;
  trial.controller.ki = 2 * trial.controller.kp;
  const std::size_t count = Samples(duration, rate);
  double from = 0;
  double t = 0;  // [s] when the next move begins
  std::vector<double> target(count, 0.0);
  for (std::size_t k = 0; k < count;) {
    double to = random.Uniform(-1.2, 1.2);
    if (std::abs(to - from) < 0.4) to = from > 0 ? from - 0.8 : from + 0.8;
    const double speed = random.Uniform(0.5, 3);
    const double acceleration = random.Uniform(6, 20);
    const double distance = std::abs(to - from);
    const double peak = std::min(speed, std::sqrt(distance * acceleration));
    const double ramp = peak / acceleration;
    const double move = distance / peak + ramp;
    const double rest = random.Uniform(0.1, 0.5);
    for (; k < count && static_cast<double>(k) / rate < t + move + rest; ++k) {
      const double s = std::clamp(static_cast<double>(k) / rate - t, 0.0, move);
      const double left = move - s;
      double way = peak * (s - 0.5 * ramp);
      if (s < ramp) way = 0.5 * acceleration * s * s;
      if (left < ramp) way = distance - 0.5 * acceleration * left * left;
      target[k] = from + std::copysign(way, to - from);
    }
    t += move + rest;
    from = to;
  }
  trial.command = std::move(target);
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
