#include "problems/ankle_on_dynamometer/laboratory/machine_program.h"

#include <algorithm>
#include <cmath>

#include "base/constants.h"

namespace sinew {
namespace {

// A servo of a few hundred watts: 0.1 degrees under 10 N m.
constexpr double kStiffness = 5000;  // [N m/rad]
constexpr double kDamping = 60;      // [N m s/rad]
constexpr double kFollowing = 0.01;  // [s] after which a free reference is where the plate is
constexpr double kCushion = 0.12;    // [rad] before an end of the range
constexpr double kRise = 0.3;        // [s] until the limit has its height
constexpr double kTurn = 0.15;       // [s] in which a rotation reaches its speed

}  // namespace

double MachineProgram::BeginAngle() const {
  return mode == MachineMode::kIsometric ? hold : highest;
}

MachineProgram::Reference MachineProgram::At(double since) const {
  // Between the turns, of raised-cosine velocity, the speed is constant.
  const double half = (highest - lowest) / speed + kTurn;
  const double halves = std::floor(since / half);
  const double t = since - halves * half;
  const auto way_of = [&](double x) {
    const auto ramp = [](double s) { return 0.5 * (s - kTurn / kPi * std::sin(kPi * s / kTurn)); };
    if (x < kTurn) return speed * ramp(x);
    if (x > half - kTurn) return (highest - lowest) - speed * ramp(half - x);
    return speed * (x - 0.5 * kTurn);
  };
  const double step = 1e-6;
  const double way = way_of(t);
  const double rate = (way_of(std::min(t + step, half)) - way_of(std::max(t - step, 0.0))) /
                      (std::min(t + step, half) - std::max(t - step, 0.0));
  const bool down = std::fmod(halves, 2) == 0;
  return down ? Reference{highest - way, -rate} : Reference{lowest + way, rate};
}

double MachineProgram::ReferenceRate(double since, double angle, double velocity, double reference) const {
  if (mode == MachineMode::kIsometric) return 0;
  if (mode == MachineMode::kRotation) return At(since).velocity;
  // The limit rises from rest, and falls before the ends of the range, as the maker's cushion does.
  const double begun = std::min(1.0, since / kRise);
  const double up = speed * begun * std::clamp((highest - reference) / kCushion, 0.0, 1.0);
  const double down = speed * begun * std::clamp((reference - lowest) / kCushion, 0.0, 1.0);
  return std::clamp(velocity + (angle - reference) / kFollowing, -down, up);
}

double MachineProgram::Torque(double since, double angle, double velocity, double reference) const {
  return kStiffness * (reference - angle) +
         kDamping * (ReferenceRate(since, angle, velocity, reference) - velocity);
}

}  // namespace sinew
