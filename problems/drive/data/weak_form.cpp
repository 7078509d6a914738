#include "problems/drive/data/weak_form.h"

#include <algorithm>
#include <cmath>

namespace sinew {
namespace {

// @param slow speed [rad/s] below which the direction is uncertain
WeakRow Window(const DriveMotion& motion, const std::vector<double>& command, std::size_t first,
               std::size_t last, double slow, double angle_unit) {
  const double middle = 0.5 * (motion.time[first] + motion.time[last]);
  const double half = 0.5 * (motion.time[last] - motion.time[first]);
  WeakRow row;
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
    row.gravity += dt * window * std::sin(angle_unit * motion.position[i]);
    row.gravity_across += dt * window * std::cos(angle_unit * motion.position[i]);
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

}  // namespace

std::vector<WeakRow> WeakRows(const DriveCommand& command, bool electric,
                              const std::vector<DriveMotion>& motions, double slow, double angle_unit) {
  constexpr double kWindow = 0.4;  // [s] long against sampling and noise, short against the motion
  constexpr std::size_t kMinimum = 12;
  std::vector<WeakRow> rows;
  for (const DriveMotion& motion : motions) {
    const std::vector<double> torque = ReplayCommand(command, motion);
    std::size_t last = 0;
    for (std::size_t first = 0; first < motion.time.size();) {
      while (last < motion.time.size() &&
             (motion.time[last] < motion.time[first] + kWindow || last < first + kMinimum)) {
        ++last;
      }
      if (last >= motion.time.size()) break;
      if (!electric || IsOn(motion, first, last))
        rows.push_back(Window(motion, torque, first, last, slow, angle_unit));
      first += std::max<std::size_t>((last - first) / 4, 1);
    }
  }
  return rows;
}

}  // namespace sinew
