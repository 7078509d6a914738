#include "problems/drive/data/motion.h"

#include <algorithm>

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

double UsualInterval(const std::vector<DriveMotion>& motions) {
  std::vector<double> steps;
  for (const DriveMotion& motion : motions) {
    for (std::size_t i = 1; i < motion.time.size(); ++i) steps.push_back(motion.time[i] - motion.time[i - 1]);
  }
  if (steps.empty()) return 0;
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  return *middle;
}

double RecordedInput(const DriveRun& run, double t) {
  if (!run.held) return Interpolate(run.input_time, run.input, t);
  const auto after = std::upper_bound(run.input_time.begin(), run.input_time.end(), t);
  return run.input[static_cast<std::size_t>(std::max<std::ptrdiff_t>(after - run.input_time.begin() - 1, 0))];
}

std::vector<double> ReplayCommand(const DriveCommand& command, const DriveMotion& motion) {
  const DriveRun& run = *motion.run;
  const DriveSeries& voltage = run.signals[kSupplyVoltage];
  const auto supply = [&](double t) { return Interpolate(voltage.time, voltage.values, t); };
  const auto recorded = [&](double t) { return RecordedInput(run, t); };
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

}  // namespace sinew
