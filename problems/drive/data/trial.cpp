#include "problems/drive/data/trial.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "problems/drive/data/channels.h"
#include "problems/drive/data/input_noise.h"

namespace sinew {
namespace {

constexpr double kSmoothing = 0.03;  // [s] half-width of the windows that speeds are estimated in

Status NoGaps(const Channel& channel, const Grid& grid, const std::string& name) {
  for (std::size_t i = 0; i < channel.values.size(); ++i) {
    if (std::isfinite(channel.values[i])) continue;
    return Fail("input '{}' has a gap at t = {:.6g} s; the motion after it is not determined: cut the trial",
                name, grid.time[i]);
  }
  return {};
}

Status ReadGains(const Dataset& data, const DriveSettings& settings, const Trial& trial, DriveRun& run) {
  const DriveControllerKind kind = settings.controller.kind;
  if (kind == DriveControllerKind::kNone) return {};
  const auto number = [&](const char* name) -> std::optional<double> {
    const auto condition = trial.conditions.find(name);
    if (condition != trial.conditions.end()) return condition->second;
    const auto given = settings.controller.numbers.find(name);
    if (given != settings.controller.numbers.end()) return given->second;
    return ConstantOf(data, name);
  };
  const auto needed = [&](const char* name, double& value) -> Status {
    const auto found = number(name);
    if (!found) {
      return Fail("the controller has no {}: give it in drive.controller, as a constant or as a condition",
                  name);
    }
    value = *found;
    return {};
  };
  DriveControllerGains& gains = run.gains;
  if (kind == DriveControllerKind::kCascade) {
    SINEW_TRY(needed("position_gain", gains.position_gain));
    SINEW_TRY(needed("velocity_gain", gains.velocity_gain));
    gains.velocity_feedforward = number("velocity_feedforward").value_or(0);
    gains.acceleration_feedforward = number("acceleration_feedforward").value_or(0);
    const std::vector<std::pair<const char*, double*>> not_negative{
        {"velocity_integral", &gains.velocity_integral},
        {"velocity_filter", &gains.velocity_filter},
        {"speed_limit", &gains.speed_limit}};
    for (const auto& [name, value] : not_negative) {
      *value = number(name).value_or(0);
      if (!(*value >= 0)) return Fail("{} is {}, expected at least 0", name, *value);
    }
    for (const auto& [name, value] :
         {std::pair("position_gain", gains.position_gain), std::pair("velocity_gain", gains.velocity_gain)}) {
      if (!(value > 0)) return Fail("{} is {}, expected above 0", name, value);
    }
  } else {
    SINEW_TRY(needed("kp", gains.kp));
    gains.ki = number("ki").value_or(0);
    gains.kd = number("kd").value_or(0);
  }
  // Dynamixel: 4096 steps per turn, gain 1/256 of a PWM of 885 at most.
  constexpr double kDynamixel = 4096 / (2 * 3.14159265358979323846) / (256 * 885);
  gains.servo_error_gain = number("servo_error_gain").value_or(kDynamixel);
  gains.output_limit = number("output_limit").value_or(0);
  if (kind == DriveControllerKind::kServo) return {};
  const auto period = number("control_period");
  if (!period) return Fail("the controller has no control_period: give it in drive.controller, in seconds");
  gains.control_period = *period;
  if (!(*period >= 1e-5 && *period <= 10))
    return Fail("control_period is {} s, expected 1e-5 to 10 s", *period);
  if (gains.output_limit < 0)
    return Fail("output_limit is {}, expected above 0, or 0 for none", gains.output_limit);
  const bool cascade = kind == DriveControllerKind::kCascade;
  if (settings.controller.integral_is_fitted && (cascade ? gains.velocity_integral : gains.ki) == 0) {
    return Fail("initial_integral is to be fitted, but {} is 0: the controller has no integral",
                cascade ? "velocity_integral" : "ki");
  }
  return {};
}

// What is added to the output of the controller.
Status ReadDisturbance(const DriveTraits& traits, const Trial& trial, DriveRun& run) {
  const Grid* grid = nullptr;
  const Channel* channel = InputIn(trial, kDisturbance, &grid);
  if (channel == nullptr) return {};
  const bool sampled =
      traits.controller != DriveControllerKind::kNone && traits.controller != DriveControllerKind::kServo;
  if (!sampled) {
    return Fail(
        "'{}' is added to the output of a sampled controller (pid_speed, pid_position, cascade), but {}",
        kDisturbance,
        traits.controller == DriveControllerKind::kServo
            ? "the controller is a servo"
            : fmt::format("the joint is driven by '{}'", traits.input_channel));
  }
  const std::string unit = traits.electric ? "V" : traits.rotary ? "N*m" : "N";
  if (channel->unit != unit)
    return Fail("'{}' has unit '{}', expected {}, that of the controller's output", kDisturbance,
                channel->unit, unit);
  SINEW_TRY(NoGaps(*channel, *grid, kDisturbance));
  run.disturbance = {grid->time, channel->values, {}};
  return {};
}

// When the motor is switched, in absolute times. A value holds from its sample to the next.
Status ReadSwitches(const Trial& trial, DriveRun& run) {
  const Grid* grid = nullptr;
  const Channel* channel = InputIn(trial, kMotorOn, &grid);
  if (channel == nullptr) {
    if (MeasuredIn(trial, kMotorOn, &grid) == nullptr) return {};
    return Fail("channel '{}' is marked measured, not input; import it with kind: input", kMotorOn);
  }
  if (channel->unit != "1") return Fail("'{}' has unit '{}', expected 1", kMotorOn, channel->unit);
  SINEW_TRY(NoGaps(*channel, *grid, kMotorOn));
  for (std::size_t i = 0; i < channel->values.size(); ++i) {
    const double value = channel->values[i];
    if (value != 0 && value != 1) {
      return Fail("'{}' is {} at t = {:.6g} s, expected 0 (the motor is off) or 1", kMotorOn, value,
                  grid->time[i]);
    }
    if (i > 0 && value != channel->values[i - 1]) run.switches.push_back(grid->time[i]);
  }
  run.on_at_begin = channel->values.front() == 1;
  return {};
}

Status ReadInput(const DriveSettings& settings, const DriveTraits& traits, const Trial& trial,
                 DriveRun& run) {
  const Grid* grid = nullptr;
  const Channel* channel = InputIn(trial, traits.input_channel, &grid);
  SINEW_TRY(NoGaps(*channel, *grid, traits.input_channel));
  run.input_time = grid->time;
  run.input = channel->values;
  run.held = settings.hold;
  if (traits.input == DriveInput::kTorque && channel->sigma) {
    run.input_noise = *channel->sigma;
    if (!run.held) run.input_cutoff = SmoothInput(run.input_time, run.input, *channel->sigma).cutoff;
  }
  run.SetSlopes();
  return {};
}

// What is recorded besides the input, where the model has a use for it.
Status ReadSignals(const Dataset& data, const DriveTraits& traits, const Trial& trial, DriveRun& run) {
  for (const DriveSignalChannel& signal : DriveSignalChannels()) {
    if (!traits.signals[signal.signal]) continue;
    DriveSeries& series = run.signals[signal.signal];
    const Grid* grid = nullptr;
    if (const Channel* channel = InputIn(trial, signal.name, &grid)) {
      if (channel->unit != signal.unit)
        return Fail("{} has unit '{}', expected {}", signal.name, channel->unit, signal.unit);
      SINEW_TRY(NoGaps(*channel, *grid, signal.name));
      series = {grid->time, channel->values, {}};
    } else if (const auto constant = NumberOf(data, trial, signal.name)) {
      series.values = {*constant};
    } else {
      return Fail("needs {}: a constant, a condition of the trial, or a channel of kind input", signal.name);
    }
  }
  return {};
}

// Where to predict, in absolute times: the measured samples within the input, and samples of the input
// around.
std::vector<double> StopsOf(const std::vector<double>& sampled, const std::vector<double>& input) {
  constexpr double kMargin = 0.1;  // [s]
  std::set<double> stops(sampled.begin(), sampled.end());
  for (const double t : input) {
    const bool before = t < sampled.front() && t >= sampled.front() - kMargin;
    const bool after = t > sampled.back() && t <= sampled.back() + kMargin;
    if (before || after) stops.insert(t);
  }
  return {stops.begin(), stops.end()};
}

// Samples of a measured channel without gaps, within the run, times from its begin.
struct Samples {
  std::vector<double> time;
  std::vector<double> values;
};
Samples SamplesOf(const Channel& channel, const Grid& grid, const DriveRun& run) {
  Samples samples;
  for (std::size_t i = 0; i < grid.time.size(); ++i) {
    const double t = grid.time[i] - run.begin;
    if (!std::isfinite(channel.values[i]) || t < 0 || t > run.stops.back()) continue;
    samples.time.push_back(t);
    samples.values.push_back(channel.values[i]);
  }
  return samples;
}

std::vector<double> SmoothedSpeed(const Samples& position) {
  std::vector<double> speed(position.time.size());
  for (std::size_t i = 0; i < speed.size(); ++i)
    speed[i] = LocalSlope(position.time, position.values, i, kSmoothing);
  return speed;
}

}  // namespace

Result<DriveRun> ReadDriveRun(const Dataset& data, const DriveSettings& settings, const DriveTraits& traits,
                              const std::string& name, const Trial& trial) {
  DriveRun run;
  run.trial = name;
  Status read = ReadInput(settings, traits, trial, run);
  if (read) read = ReadSignals(data, traits, trial, run);
  if (read) read = ReadGains(data, settings, trial, run);
  if (read) read = ReadDisturbance(traits, trial, run);
  if (read) read = ReadSwitches(trial, run);
  if (!read) return Fail("trial '{}': {}", name, read.error().message);
  const std::string torque = traits.rotary ? "torque" : "force";
  std::set<double> sampled;
  for (const std::string& channel :
       {std::string("position"), std::string("speed"), torque, std::string("current")}) {
    const Grid* grid = nullptr;
    if (MeasuredIn(trial, channel, &grid) == nullptr) continue;
    for (const double t : grid->time) {
      if (t >= run.input_time.front() && t <= run.input_time.back()) sampled.insert(t);
    }
  }
  if (sampled.size() < 3) {
    return Fail(
        "trial '{}': fewer than 3 measured samples lie within the record of '{}' ({:.4g} .. {:.4g} s)", name,
        traits.input_channel, run.input_time.front(), run.input_time.back());
  }
  run.stops = StopsOf({sampled.begin(), sampled.end()}, run.input_time);
  run.begin = run.stops.front();
  std::vector<std::vector<double>*> all_times{&run.stops, &run.input_time, &run.disturbance.time,
                                              &run.switches};
  for (DriveSeries& series : run.signals) all_times.push_back(&series.time);
  for (auto* times : all_times) {
    for (double& t : *times) t -= run.begin;
  }
  for (DriveSeries& series : run.signals) series.SetSlopes();
  run.disturbance.SetSlopes();
  run.on_at_begin = run.OnAt(0);
  const auto begun = std::upper_bound(run.switches.begin(), run.switches.end(), 0.0);
  run.switches.erase(run.switches.begin(), begun);
  run.middle = 0.5 * run.stops.back();
  return run;
}

Result<DriveMotion> MotionOf(const Trial& trial, DriveRun& run) {
  const Grid* grid = nullptr;
  DriveMotion motion;
  motion.run = &run;
  Samples position;
  Samples speed;
  if (const Channel* channel = MeasuredIn(trial, "position", &grid))
    position = SamplesOf(*channel, *grid, run);
  if (const Channel* channel = MeasuredIn(trial, "speed", &grid)) speed = SamplesOf(*channel, *grid, run);
  if (position.time.size() < 3 && speed.time.size() < 3) {
    return Fail("trial '{}': fewer than 3 samples of position or speed lie within the input's record",
                run.trial);
  }
  if (position.time.size() < 3) {  // positions by integration, from 0
    position.time = speed.time;
    position.values.assign(speed.time.size(), 0);
    for (std::size_t i = 1; i < speed.time.size(); ++i) {
      position.values[i] = position.values[i - 1] + 0.5 * (speed.values[i] + speed.values[i - 1]) *
                                                        (speed.time[i] - speed.time[i - 1]);
    }
    motion.speed_measured = true;
  }
  motion.time = position.time;
  motion.position = position.values;
  motion.speed = SmoothedSpeed(position);
  if (speed.time.size() >= 3) {
    for (std::size_t i = 0; i < motion.time.size(); ++i)
      motion.speed[i] = At(speed.time, speed.values, motion.time[i]);
  }
  // The state where the prediction begins, by the straight line of the first samples.
  std::size_t last = std::min<std::size_t>(2, motion.time.size() - 1);
  while (last + 1 < motion.time.size() && motion.time[last + 1] - motion.time[0] <= 2 * kSmoothing) ++last;
  const double slope =
      LocalSlope({motion.time.begin(), motion.time.begin() + static_cast<std::ptrdiff_t>(last) + 1},
                 {motion.position.begin(), motion.position.begin() + static_cast<std::ptrdiff_t>(last) + 1},
                 last / 2, 1e9);
  run.initial_speed = speed.time.size() >= 3 ? speed.values.front() : slope;
  run.initial_position = motion.position.front() - run.initial_speed * motion.time.front();
  return motion;
}

double At(const std::vector<double>& time, const std::vector<double>& values, double t) {
  if (values.empty()) return 0;
  if (t <= time.front()) return values.front();
  if (t >= time.back()) return values.back();
  const auto i = static_cast<std::size_t>(std::upper_bound(time.begin(), time.end(), t) - time.begin());
  return values[i - 1] + (values[i] - values[i - 1]) * (t - time[i - 1]) / (time[i] - time[i - 1]);
}

}  // namespace sinew
