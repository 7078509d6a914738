#include "problems/drive/drive_data.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "base/text.h"
#include "problems/drive/drive_starts.h"

namespace sinew {
namespace {

constexpr double kStandardGravity = 9.80665;  // [m/s2]
constexpr double kSmoothing = 0.03;           // [s] half-width of the windows that speeds are estimated in
const std::vector<std::string> kInputs{"torque", "force", "voltage", "duty", "reference"};

const Channel* MeasuredIn(const Trial& trial, const std::string& name, const Grid** grid) {
  for (const auto& [grid_name, g] : trial.grids) {
    const auto found = g.channels.find(name);
    if (found == g.channels.end() || found->second.kind != ChannelKind::kMeasured) continue;
    *grid = &g;
    return &found->second;
  }
  return nullptr;
}

const Channel* InputIn(const Trial& trial, const std::string& name, const Grid** grid) {
  for (const auto& [grid_name, g] : trial.grids) {
    const auto found = g.channels.find(name);
    if (found == g.channels.end() || found->second.kind != ChannelKind::kInput) continue;
    *grid = &g;
    return &found->second;
  }
  return nullptr;
}

Status NoGaps(const Channel& channel, const Grid& grid, const std::string& name) {
  for (std::size_t i = 0; i < channel.values.size(); ++i) {
    if (std::isfinite(channel.values[i])) continue;
    return Fail("input '{}' has a gap at t = {:.6g} s; the motion after it is not determined: cut the trial",
                name, grid.time[i]);
  }
  return {};
}

// The one input of a trial.
Result<std::string> InputName(const Trial& trial) {
  std::vector<std::string> found;
  const Grid* grid = nullptr;
  for (const std::string& name : kInputs) {
    if (InputIn(trial, name, &grid) != nullptr) found.push_back(name);
  }
  if (found.size() == 1) return found.front();
  if (found.size() > 1)
    return Fail("has {} inputs ({}), expected exactly one", found.size(), Join(found, ", "));
  for (const std::string& name : kInputs) {
    if (MeasuredIn(trial, name, &grid) == nullptr) continue;
    return Fail(
        "channel '{}' is marked measured, not input; if it drives the joint, import it with kind: input",
        name);
  }
  return Fail("has no input: expected a channel of kind input named {}", Join(kInputs, ", "));
}

struct Finder {
  const Dataset& data;
  [[nodiscard]] std::optional<double> Constant(const std::string& name) const {
    const auto found = data.constants.find(name);
    if (found == data.constants.end()) return {};
    return found->second.value;
  }
  [[nodiscard]] std::optional<double> Number(const Trial& trial, const std::string& name) const {
    const auto found = trial.conditions.find(name);
    if (found != trial.conditions.end()) return found->second;
    return Constant(name);
  }
};

Status FindTraits(const Dataset& data, const DriveSettings& settings, DriveData& out) {
  const Finder find{data};
  DriveTraits& traits = out.traits;
  std::string first_trial;
  std::string position_unit;
  for (const auto& [name, trial] : data.trials) {
    const auto input = InputName(trial);
    if (!input) return Fail("trial '{}' {}", name, input.error().message);
    const Grid* grid = nullptr;
    const Channel* channel = InputIn(trial, *input, &grid);
    if (first_trial.empty()) {
      first_trial = name;
      traits.input_channel = *input;
      traits.input_unit = channel->unit;
    } else if (*input != traits.input_channel) {
      return Fail("trial '{}' is driven by '{}', trial '{}' by '{}': expected the same input in all trials",
                  first_trial, traits.input_channel, name, *input);
    }
    const auto check_unit = [&](const char* of, const char* rotary, const char* linear) -> Status {
      const Channel* measured = MeasuredIn(trial, of, &grid);
      if (measured == nullptr) return {};
      const std::string& unit = measured->unit;
      if (unit != rotary && unit != linear) {
        return Fail("trial '{}': {} has unit '{}', expected {} (rotary) or {} (linear)", name, of, unit,
                    rotary, linear);
      }
      const std::string kind = unit == rotary ? "rad" : "m";
      if (!position_unit.empty() && position_unit != kind) {
        return Fail("trial '{}': {} has unit '{}', but the joint is {} elsewhere", name, of, unit,
                    position_unit == "rad" ? "rotary" : "linear");
      }
      position_unit = kind;
      return {};
    };
    SINEW_TRY(check_unit("position", "rad", "m"));
    SINEW_TRY(check_unit("speed", "rad/s", "m/s"));
  }
  if (data.trials.empty()) return Fail("holds no trial");
  if (position_unit.empty()) {
    return Fail("no trial has a measured position [rad or m] or speed [rad/s or m/s]: nothing to fit");
  }
  traits.rotary = position_unit == "rad";
  const std::string& input = traits.input_channel;
  const std::string expected = input == "torque" || input == "force" ? (traits.rotary ? "N*m" : "N")
                               : input == "voltage"                  ? "V"
                               : input == "duty"                     ? "1"
                               : settings.controller.kind == DriveControllerKind::kPidSpeed
                                   ? (traits.rotary ? "rad/s" : "m/s")
                                   : (traits.rotary ? "rad" : "m");
  if (traits.input_unit != expected) {
    return Fail("input '{}' has unit '{}', expected {} for a {} joint{}", input, traits.input_unit, expected,
                traits.rotary ? "rotary" : "linear", input == "reference" ? " with this controller" : "");
  }
  const bool closed = input == "reference";
  const DriveControllerKind kind = settings.controller.kind;
  if (closed && kind == DriveControllerKind::kNone) {
    return Fail("the input is a reference: expected the controller that follows it, under drive.controller");
  }
  if (!closed && kind != DriveControllerKind::kNone) {
    return Fail("drive.controller needs the input 'reference', but the trials are driven by '{}'", input);
  }
  traits.controller = kind;
  traits.input = input == "voltage" ? DriveInput::kVoltage
                 : input == "duty"  ? DriveInput::kDuty
                 : closed           ? DriveInput::kReference
                                    : DriveInput::kTorque;
  traits.electric = traits.input == DriveInput::kVoltage || traits.input == DriveInput::kDuty ||
                    kind == DriveControllerKind::kServo || (closed && settings.controller.gives_voltage);
  traits.held = settings.hold;
  const std::vector<std::pair<const char*, DriveSlot>> kBase{
      {"inertia", kInertia},      {"viscous_friction", kViscousFriction}, {"gravity_torque", kGravityTorque},
      {"drive_gain", kDriveGain}, {"torque_constant", kTorqueConstant},   {"resistance", kResistance}};
  for (const auto& [name, slot] : kBase) {
    traits.fixed[slot] = find.Constant(name);
    const bool may_be_zero = slot == kViscousFriction || slot == kGravityTorque;
    if (traits.fixed[slot] && !may_be_zero && !(*traits.fixed[slot] > 0)) {
      return Fail("constant '{}' is {}, expected above 0", name, *traits.fixed[slot]);
    }
  }

  DriveJoint& joint = out.joint;
  joint.rotary = traits.rotary;
  joint.electric = traits.electric;
  const auto mass = find.Constant("load_mass");
  const auto length = find.Constant("load_length");
  if (traits.rotary && mass.has_value() != length.has_value()) {
    return Fail("constant '{}' is given without '{}': a known load needs both",
                mass ? "load_mass" : "load_length", mass ? "load_length" : "load_mass");
  }
  if (traits.rotary && mass) {
    joint.load_known = true;
    joint.load_inertia = *mass * *length * *length;
    joint.load_gravity = *mass * kStandardGravity * *length;
  }
  traits.load_known = joint.load_known;
  joint.incline_force = find.Constant("incline_force").value_or(0);
  joint.gear_ratio = find.Constant("gear_ratio").value_or(1);
  if (!(joint.gear_ratio > 0)) return Fail("constant 'gear_ratio' is {}, expected above 0", joint.gear_ratio);
  if (const auto poles = find.Constant("pole_pairs"); poles && *poles > 0 && traits.rotary) {
    traits.pole_period = 2 * 3.14159265358979323846 / (*poles * joint.gear_ratio);
  }
  out.command.input = traits.input;
  out.command.controller = kind;
  if (settings.step) out.command.step = *settings.step;
  return {};
}

Status ReadGains(const Finder& find, const DriveSettings& settings, const Trial& trial, DriveRun& run) {
  const DriveControllerKind kind = settings.controller.kind;
  if (kind == DriveControllerKind::kNone) return {};
  const auto number = [&](const char* name) -> std::optional<double> {
    const auto condition = trial.conditions.find(name);
    if (condition != trial.conditions.end()) return condition->second;
    const auto given = settings.controller.numbers.find(name);
    if (given != settings.controller.numbers.end()) return given->second;
    return find.Constant(name);
  };
  const auto kp = number("kp");
  if (!kp)
    return Fail("the controller has no kp: give it in drive.controller, as a constant or as a condition");
  run.gains.kp = *kp;
  // Dynamixel: 4096 steps per turn, gain 1/256 of a PWM of 885 at most.
  constexpr double kDynamixel = 4096 / (2 * 3.14159265358979323846) / (256 * 885);
  run.gains.servo_error_gain = number("servo_error_gain").value_or(kDynamixel);
  run.gains.ki = number("ki").value_or(0);
  run.gains.kd = number("kd").value_or(0);
  run.gains.output_limit = number("output_limit").value_or(0);
  if (kind == DriveControllerKind::kServo) return {};
  const auto period = number("control_period");
  if (!period) return Fail("the controller has no control_period: give it in drive.controller, in seconds");
  run.gains.control_period = *period;
  if (!(*period >= 1e-5 && *period <= 10))
    return Fail("control_period is {} s, expected 1e-5 to 10 s", *period);
  if (run.gains.output_limit < 0) {
    return Fail("output_limit is {}, expected above 0, or 0 for none", run.gains.output_limit);
  }
  return {};
}

Status ReadInput(const Dataset& data, const DriveSettings& settings, const DriveTraits& traits,
                 const Trial& trial, DriveRun& run) {
  const Grid* grid = nullptr;
  const Channel* channel = InputIn(trial, traits.input_channel, &grid);
  SINEW_TRY(NoGaps(*channel, *grid, traits.input_channel));
  run.input_time = grid->time;
  run.input = channel->values;
  run.held = settings.hold;
  run.slope.assign(run.input.size(), 0);
  for (std::size_t i = 0; !run.held && i + 1 < run.input.size(); ++i) {
    run.slope[i] = (run.input[i + 1] - run.input[i]) / (run.input_time[i + 1] - run.input_time[i]);
  }
  const bool needs_supply =
      traits.input == DriveInput::kDuty || traits.controller == DriveControllerKind::kServo;
  if (needs_supply) {
    if (const Channel* supply = InputIn(trial, "supply_voltage", &grid)) {
      SINEW_TRY(NoGaps(*supply, *grid, "supply_voltage"));
      run.supply_time = grid->time;
      run.supply = supply->values;
    } else if (const auto constant = Finder{data}.Number(trial, "supply_voltage")) {
      run.supply = {*constant};
    } else {
      return Fail("needs supply_voltage: a constant, a condition of the trial, or a channel of kind input");
    }
  }
  return ReadGains(Finder{data}, settings, trial, run);
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

double At(const std::vector<double>& time, const std::vector<double>& values, double t) {
  if (values.empty()) return 0;
  if (t <= time.front()) return values.front();
  if (t >= time.back()) return values.back();
  const auto i = static_cast<std::size_t>(std::upper_bound(time.begin(), time.end(), t) - time.begin());
  return values[i - 1] + (values[i] - values[i - 1]) * (t - time[i - 1]) / (time[i] - time[i - 1]);
}

std::vector<double> SmoothedSpeed(const Samples& position) {
  std::vector<double> speed(position.time.size());
  for (std::size_t i = 0; i < speed.size(); ++i)
    speed[i] = LocalSlope(position.time, position.values, i, kSmoothing);
  return speed;
}

Result<DriveMotion> MotionOf(const Trial& trial, const std::string& name, DriveRun& run) {
  const Grid* grid = nullptr;
  DriveMotion motion;
  Samples position;
  Samples speed;
  if (const Channel* channel = MeasuredIn(trial, "position", &grid))
    position = SamplesOf(*channel, *grid, run);
  if (const Channel* channel = MeasuredIn(trial, "speed", &grid)) speed = SamplesOf(*channel, *grid, run);
  if (position.time.size() < 3 && speed.time.size() < 3) {
    return Fail("trial '{}': fewer than 3 samples of position or speed lie within the input's record", name);
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

struct Spread {
  double deviation = 0;
  double largest = 0;
  std::size_t count = 0;
  bool all_sigma = true;
  std::optional<double> least_sigma;
};

// Over all training blocks of a channel: they share one weight.
Spread SpreadOf(const DriveData& data, std::size_t channel) {
  Spread spread;
  double sum = 0;
  for (std::size_t b = 0; b < data.layout.size(); ++b) {
    const Block& block = data.layout[b];
    if (data.blocks[b].channel != static_cast<int>(channel) || block.measured.empty()) continue;
    if (block.sigma) {
      spread.least_sigma = std::min(spread.least_sigma.value_or(*block.sigma), *block.sigma);
    } else {
      spread.all_sigma = false;
    }
    if (block.role == BlockRole::kValidate) continue;
    for (const double value : block.measured) {
      sum += value;
      spread.largest = std::max(spread.largest, std::abs(value));
      ++spread.count;
    }
  }
  if (spread.count == 0) return spread;
  const auto n = static_cast<double>(spread.count);
  const double mean = sum / n;
  double variance = 0;  // in two passes: positions far from zero must not lose their digits
  for (std::size_t b = 0; b < data.layout.size(); ++b) {
    if (data.blocks[b].channel != static_cast<int>(channel)) continue;
    if (data.layout[b].role == BlockRole::kValidate) continue;
    for (const double value : data.layout[b].measured) variance += (value - mean) * (value - mean) / n;
  }
  spread.deviation = std::sqrt(variance);
  return spread;
}

Status AddBlocks(const std::string& name, const Trial& trial, const std::vector<std::string>& fit,
                 int run_index, const DriveMotion& motion, double margin, DriveData& out) {
  const DriveRun& run = out.runs[static_cast<std::size_t>(run_index)];
  const bool rotary = out.traits.rotary;
  const std::vector<std::string> units{rotary ? "rad" : "m", rotary ? "rad/s" : "m/s", rotary ? "N*m" : "N",
                                       "A"};
  const std::vector<std::string> quantities{"position", "speed",
                                            rotary ? "torque of the drive" : "force of the drive", "current"};
  const Grid* primary = nullptr;
  if (MeasuredIn(trial, "position", &primary) == nullptr) MeasuredIn(trial, "speed", &primary);
  for (std::size_t c = 0; c < kDriveChannels.size(); ++c) {
    if (kDriveChannels[c] == "current" && !out.traits.electric) continue;
    const std::string channel = kDriveChannels[c] == "torque" && !rotary ? "force" : kDriveChannels[c];
    const bool fitted = std::find(fit.begin(), fit.end(), kDriveChannels[c]) != fit.end();
    const Grid* grid = primary;
    const Channel* measured = MeasuredIn(trial, channel, &grid);
    if (measured != nullptr && measured->unit != units[c]) {
      return Fail("trial '{}': {} has unit '{}', expected {}", name, channel, measured->unit, units[c]);
    }
    Block block;
    block.trial = name;
    block.channel = channel;
    block.quantity = quantities[c];
    block.unit = units[c];
    block.role = !fitted                      ? BlockRole::kPredicted
                 : trial.role == Role::kTrain ? BlockRole::kTrain
                                              : BlockRole::kValidate;
    DriveBlock made;
    made.run = run_index;
    made.channel = static_cast<int>(c);
    made.rows.assign(run.stops.size(), -1);
    std::size_t sample = 0;
    for (std::size_t stop = 0; stop < run.stops.size(); ++stop) {
      const double t = run.begin + run.stops[stop];
      while (sample < grid->time.size() && grid->time[sample] - run.begin < run.stops[stop]) ++sample;
      const bool sampled = sample < grid->time.size() && grid->time[sample] - run.begin == run.stops[stop];
      const bool outside = t < grid->time.front() || t > grid->time.back();
      if (!sampled && !(margin > 0 && outside)) continue;
      const int row = static_cast<int>(block.prediction_time.size());
      made.rows[stop] = row;
      block.prediction_time.push_back(sampled ? grid->time[sample] : t);
      if (measured == nullptr || !sampled || !std::isfinite(measured->values[sample])) continue;
      block.sample.push_back(row);
      block.measured.push_back(measured->values[sample]);
      made.position.push_back(At(motion.time, motion.position, run.stops[stop]));
      made.velocity.push_back(At(motion.time, motion.speed, run.stops[stop]));
      made.command.push_back(At(run.input_time, run.input, run.stops[stop]));
    }
    if (measured != nullptr) block.sigma = measured->sigma;
    if (fitted && block.measured.empty()) {
      return Fail("trial '{}': channel '{}' is to be fitted but {}", name, channel,
                  measured != nullptr ? "has no usable sample" : "is not measured");
    }
    if (block.prediction_time.empty()) continue;  // nothing to say on this grid
    if (fitted && measured != nullptr && block.measured.size() < measured->values.size()) {
      out.notes.push_back(
          fmt::format("trial '{}': {} of {} samples of '{}' are not compared (gaps, or no input there)", name,
                      measured->values.size() - block.measured.size(), measured->values.size(), channel));
    }
    out.layout.push_back(std::move(block));
    out.blocks.push_back(std::move(made));
  }
  return {};
}

void MeasureScales(const std::vector<DriveMotion>& motions, DriveData& data) {
  DriveScales& s = data.scales;
  double low = INFINITY;
  double high = -INFINITY;
  double speed = 0;
  double low_command = INFINITY;
  double high_command = -INFINITY;
  s.duration = 0;
  s.shortest = INFINITY;
  double drive = 0;
  for (const DriveMotion& motion : motions) {
    for (const double q : motion.position) {
      low = std::min(low, q);
      high = std::max(high, q);
    }
    for (const double v : motion.speed) speed = std::max(speed, std::abs(v));
    for (const double u : motion.run->input) {
      low_command = std::min(low_command, u);
      high_command = std::max(high_command, u);
    }
    for (const double u : ReplayCommand(data.command, motion)) drive = std::max(drive, std::abs(u));
    s.duration = std::max(s.duration, motion.run->stops.back());
    s.shortest = std::min(s.shortest, motion.run->stops.back());
  }
  s.position = high > low ? high - low : 1;
  s.lowest = low;
  s.highest = high > low ? high : low + 1;
  s.speed = speed > 0 ? speed : 1;
  s.command = std::max({std::abs(low_command), std::abs(high_command), 1e-12});
  s.lowest_command = low_command;
  s.highest_command = high_command > low_command ? high_command : low_command + 1;
  data.joint.largest_command = s.command;
  if (data.command.controller == DriveControllerKind::kServo) data.joint.largest_command = 1;
  if (data.command.sampled()) {
    double limit = 0;
    for (const DriveMotion& motion : motions) limit = std::max(limit, motion.run->gains.output_limit);
    data.traits.compressible = limit > 0;
    data.joint.largest_command = limit > 0 ? limit : 1;
  }
  s.torque = drive;
  if (data.traits.electric)
    s.torque *= data.joint.gear_ratio * data.starts[kTorqueConstant] / data.starts[kResistance];
  // A joint that swings freely has no drive torque: gravity and inertia are the measure then.
  s.torque = std::max({s.torque, 1e-3 * data.starts[kInertia] * s.speed / 0.1, 1e-12});
  data.joint.largest_torque = s.torque;
  data.joint.largest_speed = s.speed;
  data.command.most_position = 1e5 * (std::max(std::abs(low), std::abs(high)) + s.position);
  data.command.most_speed = 1e5 * s.speed;
}

}  // namespace

Result<DriveData> PrepareDriveData(const Dataset& data, const DriveSettings& settings, double margin) {
  DriveData out;
  SINEW_TRY(FindTraits(data, settings, out));
  std::vector<std::string> fit = settings.fit;
  const std::string torque = out.traits.rotary ? "torque" : "force";
  if (std::find(fit.begin(), fit.end(), "torque") != fit.end() && out.traits.input_channel == torque) {
    return Fail("fit: '{}' is the input of these trials, it cannot be fitted", torque);
  }
  if (std::find(fit.begin(), fit.end(), "current") != fit.end() && !out.traits.electric) {
    return Fail("fit: the drive is not electric (input '{}'): it has no current", out.traits.input_channel);
  }
  if (fit.empty()) {
    const Grid* grid = nullptr;
    const bool has_position = std::any_of(data.trials.begin(), data.trials.end(), [&](const auto& trial) {
      return MeasuredIn(trial.second, "position", &grid) != nullptr;
    });
    fit = {has_position ? "position" : "speed"};
  }

  std::vector<const Trial*> trials;
  for (const auto& [name, trial] : data.trials) {
    DriveRun run;
    run.trial = name;
    const Status read = ReadInput(data, settings, out.traits, trial, run);
    if (!read) return Fail("trial '{}': {}", name, read.error().message);
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
          "trial '{}': fewer than 3 measured samples lie within the record of '{}' ({:.4g} .. {:.4g} s)",
          name, out.traits.input_channel, run.input_time.front(), run.input_time.back());
    }
    run.stops = StopsOf({sampled.begin(), sampled.end()}, run.input_time);
    run.begin = run.stops.front();
    for (auto* times : {&run.stops, &run.input_time, &run.supply_time}) {
      for (double& t : *times) t -= run.begin;
    }
    run.middle = 0.5 * run.stops.back();
    out.runs.push_back(std::move(run));
    trials.push_back(&trial);
  }
  std::vector<DriveMotion> motions;
  for (std::size_t r = 0; r < out.runs.size(); ++r) {
    SINEW_ASSIGN(DriveMotion motion, MotionOf(*trials[r], out.runs[r].trial, out.runs[r]));
    motions.push_back(std::move(motion));
    motions.back().run = &out.runs[r];
  }
  std::vector<DriveMotion> training;
  for (std::size_t r = 0; r < motions.size(); ++r) {
    if (trials[r]->role == Role::kTrain) training.push_back(motions[r]);
  }
  if (training.empty()) return Fail("no trial has the role train: nothing to fit");
  out.starts = EstimateDriveStarts(out.joint, out.command, training, out.traits.fixed);
  MeasureScales(motions, out);
  for (std::size_t r = 0; r < out.runs.size(); ++r) {
    SINEW_TRY(AddBlocks(out.runs[r].trial, *trials[r], fit, static_cast<int>(r), motions[r], margin, out));
  }

  out.known_noise = true;
  std::vector<Spread> spreads;
  for (std::size_t c = 0; c < kDriveChannels.size(); ++c) {
    spreads.push_back(SpreadOf(out, c));
    const bool fitted = std::find(fit.begin(), fit.end(), kDriveChannels[c]) != fit.end();
    if (!fitted) continue;
    if (!(spreads[c].deviation > 1e-12 * spreads[c].largest))
      return Fail("channel '{}' does not vary: nothing to fit", kDriveChannels[c]);
    out.known_noise = out.known_noise && spreads[c].all_sigma;
  }
  out.scales.noise = spreads[0].least_sigma.value_or(0.01 * std::max(spreads[0].deviation, 1e-9));
  for (std::size_t b = 0; b < out.layout.size(); ++b) {
    Block& block = out.layout[b];
    if (block.role == BlockRole::kPredicted) continue;
    const Spread& spread = spreads[static_cast<std::size_t>(out.blocks[b].channel)];
    block.weight = out.known_noise ? 1 / *block.sigma
                                   : 1 / (spread.deviation * std::sqrt(static_cast<double>(spread.count)));
  }
  return out;
}

std::string DescribeDriveChannels() {
  return "input (kind: input), exactly one, without gaps, any sampling:\n"
         "  torque or force        N*m, N        of the drive\n"
         "  voltage                V             at the motor\n"
         "  duty                   1             share of supply_voltage at the motor\n"
         "  reference              rad, rad/s (linear: m, m/s)   of the known controller, see drive.yaml\n"
         "measured, any sampling, gaps are left out; position or speed is needed:\n"
         "  position               rad or m      tells whether the joint is rotary or linear\n"
         "  speed                  rad/s or m/s\n"
         "  torque or force        N*m, N        of the drive, if it is not the input\n"
         "  current                A             of an electric drive\n"
         "constants, all optional:\n"
         "  load_mass, load_length kg, m         a known load on a rotary joint: fixes the scale of torque\n"
         "  gear_ratio             1             between motor and joint; default 1\n"
         "  supply_voltage         V             needed for duty and servos; also a condition or an input\n"
         "  incline_force          N             gravity along a linear axis\n"
         "  pole_pairs             1             of the motor, for cogging\n"
         "  kp, ki, kd, ...                      of the controller; also conditions of a trial\n"
         "  inertia, torque_constant, ...        fixes the base parameter of that name\n"
         "files:\n"
         "  drive.yaml                           settings with key `drive` (optional; or give --config)\n";
}

}  // namespace sinew
