#include "problems/drive/laboratory/synthesis.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/random.h"
#include "problems/drive/laboratory/exact.h"
#include "problems/drive/laboratory/excitation.h"
#include "problems/kit/experiment_settings.h"

namespace sinew {
namespace {

// Everything that --set takes, with its default and range; the second default is that of the orthosis.
struct Setting {
  const char* name;
  double value;
  double of_orthosis;
  double lower;
  double upper;
  const char* description;
};
constexpr Setting kSettings[] = {
    {"inertia", 0.04, 1.25, 1e-6, 1e3, "true inertia [kg*m2]"},
    {"viscous_friction", 0.05, 3, 0, 1e3, "true viscous friction [N*m*s/rad]"},
    {"gravity_torque", 0.6, 1.5, 0, 1e4, "true gravity torque [N*m]"},
    {"train", 4, 3, 1, 100, "number of training trials"},
    {"validate", 2, 2, 0, 100, "number of validation trials"},
    {"duration", 10, 20, 0.5, 1000, "of a trial [s]"},
    {"rate", 100, 100, 10, 5000, "samples per second [Hz]"},
    {"position_noise", 0.003, 0.001, 0, 1, "standard deviation of the position's noise [rad]"},
    {"noise_rho", 0, 0, 0, 0.999, "correlation of neighbouring samples of the noise's slow part"},
    {"noise_slow", 1, 1, 0, 1, "share of the slow part; 1: AR(1), less: noise that is no AR"},
    {"speed", 0, 1, 0, 1, "1: the speed is recorded too"},
    {"speed_noise", 0.02, 0.02, 0, 10, "standard deviation of the speed's noise [rad/s], white"},
    {"known_noise", 1, 1, 0, 1, "0: the data do not state the noise level"},
    {"excitation", 0, 0, 0, 2,
     "0: sum of sines; 1: trapezoidal moves in closed loop, torque recorded; 2: sum of sines with peaks of 2 "
     "to 4 times the gravity torque, which turn the joint over"},
    {"cascade", 0, 0, 0, 2,
     "1: trapezoidal moves of the reference, followed by a cascade of position and speed controller (P/P) "
     "that "
     "is in drive.yaml; 2: its speed controller has an integral (P/PI)"},
    {"disturbance", 0, 0, 0, 1e3, "with cascade: amplitude of a sum of sines added to its output [N*m]"},
    {"motor_off", 0, 0, 0, 1000, "the motor is off for so long at the end of each trial [s]"},
    {"mafo", 0, 1, 0, 1, "1: the five trials of the motorised ankle-foot orthosis"},
    {"hidden", 0, 0, 0, 1,
     "1, with mafo: command_delay 0.18 s and coulomb_torque 1.5 N m are hidden in the truth"},
    {"warming", 0, 0, 0, 100,
     "rise of the joint's temperature over all trials [K], which is recorded; 0: neither"},
    {"session", 0, 0, 0, 1e5,
     "pause between trials of a session [s], which follow each other; when each began is recorded; 0: "
     "neither"},
    {"exact", 0, 0, 0, 1,
     "1: position and speed are those of the fitted model itself, without noise, and start at "
     "initial_position@TRIAL, initial_speed@TRIAL (0)"},
};

using Values = std::map<std::string, double>;

// initial_position@TRIAL, initial_speed@TRIAL
bool IsStart(const std::string& name) {
  return name.rfind("initial_position@", 0) == 0 || name.rfind("initial_speed@", 0) == 0;
}

Result<Values> ReadSettings(const SynthesisRequest& request) {
  const auto mafo = request.set.find("mafo");
  const bool orthosis = mafo != request.set.end() && mafo->second != 0;
  Values values;
  for (const Setting& setting : kSettings)
    values[setting.name] = orthosis ? setting.of_orthosis : setting.value;
  for (const auto& [name, value] : request.set) {
    if (IsStart(name)) continue;
    SINEW_ASSIGN(const Setting* setting, FindSetting(kSettings, name, value));
    const bool fixed = name == "train" || name == "validate" || name == "excitation" || name == "cascade";
    if (orthosis && fixed && value != setting->of_orthosis) {
      return Fail("--set {}={}: the trials of the orthosis (mafo=1) are fixed", name, value);
    }
    values[name] = value;
  }
  SINEW_TRY(ScaleNoise(request.noise, {"position_noise", "speed_noise"}, values));
  return values;
}

std::vector<DriveTrial> OrthosisTrials(const Values& values) {
  // A speed loop of about 8 Hz: kp / inertia = 48 rad/s.
  const DriveController controller{60, 600, 0, 0.01, 232.38};
  const double speeds[][2] = {{5, 5}, {10, 10}, {20, 20}, {10, 20}, {20, 10}};
  std::vector<DriveTrial> trials;
  for (const auto& [first, second] : speeds) {
    trials.push_back(
        BackAndForth(first * kDegree, second * kDegree, values.at("duration"), values.at("rate")));
    trials.back().controller = controller;
  }
  return trials;
}

std::string SettingsText(const DrivePlan& plan) {
  std::string text = "# How the drive problem sees this joint.\ndrive:\n  fit: [position]\n";
  if (plan.exact) text += "  step: 0.01\n";  // the same for whoever reads it, whatever is measured
  if (plan.orthosis) {
    const DriveController& c = plan.trials.front().controller;
    text += fmt::format(
        "  controller:\n    kind: pid_speed\n    kp: {}\n    ki: {}\n    kd: {}\n    control_period: {}\n"
        "    output_limit: {}\n",
        c.kp, c.ki, c.kd, c.control_period, c.output_limit);
  }
  if (plan.cascade) {
    const DriveTrial& trial = plan.trials.front();
    const DriveCascade& c = trial.cascade;
    text += fmt::format(
        "  controller:\n    kind: cascade\n    position_gain: {}\n    velocity_gain: {}\n"
        "    velocity_integral: {}\n    velocity_filter: {}\n    velocity_feedforward: {}\n"
        "    acceleration_feedforward: {}\n    control_period: {}\n    output_limit: {}\n",
        c.position_gain, c.velocity_gain, c.velocity_integral, c.velocity_filter, c.velocity_feedforward,
        c.acceleration_feedforward, trial.controller.control_period, trial.controller.output_limit);
    // The loop has run for a while before the record begins.
    if (c.velocity_integral > 0) text += "    initial_integral: fitted\n";
  }
  return text;
}

// One trial after the other; 95 % of the rise are reached at the end of the last.
void WarmUp(double rise, double duration, std::vector<DriveTrial>& trials) {
  const double session = duration * static_cast<double>(trials.size());
  for (std::size_t i = 0; i < trials.size(); ++i)
    trials[i].warming = {rise, session / 3, duration * static_cast<double>(i)};
}

// Without a motor for so long at the end.
void SwitchOff(double seconds, DriveTrial& trial) {
  if (!(seconds > 0)) return;
  const auto off = static_cast<std::size_t>(std::lround(seconds * trial.rate));
  trial.motor_on.assign(trial.command.size(), 1.0);
  std::fill(trial.motor_on.end() - static_cast<std::ptrdiff_t>(std::min(off + 1, trial.motor_on.size())),
            trial.motor_on.end(), 0.0);
}

Channel NewChannel(const std::string& unit, ChannelKind kind, const Vector& values) {
  Channel channel;
  channel.unit = unit;
  channel.kind = kind;
  channel.values.assign(values.data(), values.data() + values.size());
  return channel;
}

Result<Trial> RecordTrial(const DrivePlan& plan, std::size_t index) {
  const DriveTrial& trial = plan.trials[index];
  SINEW_ASSIGN(DriveRecord record, SimulateDrive(plan.truth, trial, plan.step));
  const Eigen::Index count = record.position.size();
  record.position += DrawPositionNoise(plan, index, count);
  ReadPosition(plan.truth, record.position);
  Trial result;
  result.role = index < plan.train ? Role::kTrain : Role::kValidate;
  Grid& grid = result.grids["joint"];
  for (Eigen::Index k = 0; k < count; ++k) grid.time.push_back(static_cast<double>(k) / trial.rate);
  grid.channels["position"] = NewChannel("rad", ChannelKind::kMeasured, record.position);
  if (plan.known_noise && plan.position_noise.sigma > 0) {
    grid.channels["position"].sigma = plan.position_noise.sigma;
  }
  const bool pid = trial.control == DriveControl::kPidSpeed;
  grid.channels[pid || plan.cascade ? "reference" : "torque"] = NewChannel(pid            ? "rad/s"
                                                                           : plan.cascade ? "rad"
                                                                                          : "N*m",
                                                                           ChannelKind::kInput, record.input);
  const auto add_input = [&](const char* name, const char* unit, const std::vector<double>& values) {
    if (!values.empty()) grid.channels[name] = {unit, ChannelKind::kInput, {}, values};
  };
  add_input("disturbance", "N*m", trial.disturbance);
  add_input("motor_on", "1", trial.motor_on);
  if (trial.warming.rise > 0)
    grid.channels["temperature"] = NewChannel("K", ChannelKind::kInput, record.temperature);
  if (plan.session) result.conditions["session_time_s"] = trial.session;
  if (plan.speed) {
    Random random(Random::StreamSeed(plan.seed, 2000 + index));
    for (double& value : record.speed) value += plan.speed_noise * random.Normal();
    grid.channels["speed"] = NewChannel("rad/s", ChannelKind::kMeasured, record.speed);
    if (plan.known_noise && plan.speed_noise > 0) grid.channels["speed"].sigma = plan.speed_noise;
  }
  if (pid) {
    const auto& command = trial.command;
    result.task = "ankle range back and forth";
    result.conditions["first_speed_rad_per_s"] = std::abs(command[1]);
    result.conditions["second_speed_rad_per_s"] = std::abs(command.back());
  } else {
    const bool moves = trial.control == DriveControl::kTracking || plan.cascade;
    result.task = moves ? "moves between angles" : "sum of sines";
  }
  return result;
}

}  // namespace

Result<DrivePlan> PlanDrive(const SynthesisRequest& request) {
  SINEW_ASSIGN(const Values values, ReadSettings(request));
  const auto is = [&](const char* name) { return values.at(name) != 0; };
  DrivePlan plan;
  plan.seed = request.seed;
  plan.truth[kInertia] = values.at("inertia");
  plan.truth[kViscousFriction] = values.at("viscous_friction");
  plan.truth[kGravityTorque] = values.at("gravity_torque");
  plan.position_noise = {values.at("position_noise"), values.at("noise_slow"), values.at("noise_rho")};
  plan.speed_noise = values.at("speed_noise");
  plan.speed = is("speed");
  plan.known_noise = is("known_noise");
  plan.orthosis = is("mafo");
  plan.exact = is("exact");
  for (const auto& [name, value] : request.set) {
    if (!IsStart(name)) continue;
    if (!plan.exact) return Fail("--set {}: expected together with exact=1", name);
    plan.starts[name] = value;
  }
  plan.train = static_cast<std::size_t>(values.at("train"));
  if (is("hidden")) {
    if (!plan.orthosis) return Fail("--set hidden=1: expected together with mafo=1; else use --effect");
    plan.truth[kCommandDelay] = 0.18;
    plan.truth[kCoulombTorque] = 1.5;
  }
  plan.cascade = is("cascade");
  if (plan.cascade && is("excitation"))
    return Fail("--set excitation={}: expected without cascade, which has moves of its own",
                values.at("excitation"));
  if (is("disturbance") && !plan.cascade)
    return Fail("--set disturbance={}: expected together with cascade", values.at("disturbance"));
  if (values.at("motor_off") >= values.at("duration"))
    return Fail("--set motor_off={}: expected less than the duration of a trial, {} s",
                values.at("motor_off"), values.at("duration"));
  SINEW_TRY(HideEffects(request.effects, plan.orthosis || plan.cascade ? "reference" : "torque", plan.truth));
  if (plan.orthosis) {
    plan.trials = OrthosisTrials(values);
  } else {
    const std::size_t count = plan.train + static_cast<std::size_t>(values.at("validate"));
    const DriveTruth nominal = WithoutEffects(plan.truth);
    for (std::size_t i = 0; i < count; ++i) {
      Random random(Random::StreamSeed(request.seed, i));
      if (values.at("excitation") == 2) {
        plan.trials.push_back(DrawOverTheTop(nominal, values.at("duration"), values.at("rate"), random));
        plan.step = kOverTheTopStep;
        continue;
      }
      if (plan.cascade) {
        plan.trials.push_back(DrawCascaded(nominal, values.at("cascade") == 2, values.at("disturbance"),
                                           values.at("duration"), values.at("rate"), random));
        continue;
      }
      if (is("excitation")) {
        plan.trials.push_back(DrawTrapezoid(nominal, values.at("duration"), values.at("rate"), random));
        continue;
      }
      SINEW_ASSIGN(DriveTrial trial,
                   DrawMultiSine(nominal, values.at("duration"), values.at("rate"), random));
      plan.trials.push_back(std::move(trial));
    }
  }
  if (plan.truth[kFrictionTemperature] != 0 && !is("warming"))
    return Fail("--effect friction_with_temperature: expected together with --set warming=KELVIN");
  if (plan.truth[kSessionRate] != 0 && !is("session"))
    return Fail("--effect gain_over_session: expected together with --set session=SECONDS");
  WarmUp(values.at("warming"), values.at("duration"), plan.trials);
  for (DriveTrial& trial : plan.trials) SwitchOff(values.at("motor_off"), trial);
  plan.session = is("session");
  for (std::size_t i = 0; plan.session && i < plan.trials.size(); ++i)
    plan.trials[i].session = static_cast<double>(i) * (values.at("duration") + values.at("session"));
  SINEW_ASSIGN(const double scale, CommandScale(WithoutEffects(plan.truth), plan.trials));
  for (DriveTrial& trial : plan.trials) trial.command_scale = scale;
  return plan;
}

DriveTruth WithoutEffects(const DriveTruth& joint) {
  DriveTruth bare;
  bare[kInertia] = joint[kInertia];
  bare[kViscousFriction] = joint[kViscousFriction];
  bare[kGravityTorque] = joint[kGravityTorque];
  return bare;
}

Result<double> CommandScale(const DriveTruth& truth, const std::vector<DriveTrial>& trials) {
  double scale = 0;
  for (const DriveTrial& trial : trials) {
    if (trial.control == DriveControl::kTorque) {
      for (const double value : trial.command) scale = std::max(scale, std::abs(value));
      continue;
    }
    if (trial.controller.output_limit > 0) {  // what a known controller can command at most
      scale = std::max(scale, trial.controller.output_limit);
      continue;
    }
    SINEW_ASSIGN(const DriveRecord record, SimulateDrive(truth, trial, kSignatureStep));
    const bool recorded = trial.control == DriveControl::kTracking;
    scale = std::max(scale, (recorded ? record.input : record.torque).cwiseAbs().maxCoeff());
  }
  return scale > 0 ? scale : 1;
}

Vector DrawPositionNoise(const DrivePlan& plan, std::size_t trial, Eigen::Index count) {
  Random random(Random::StreamSeed(plan.seed, 1000 + trial));
  return plan.position_noise.Draw(count, random);
}

Result<Dataset> RecordDrive(const DrivePlan& plan) {
  Dataset data;
  data.title = plan.orthosis ? "motorised ankle-foot orthosis under speed control" : "one driven joint";
  data.subject = plan.orthosis ? "orthosis without a person" : "rotary joint with gravity";
  data.source = "sinew data synthesize drive";
  data.licence = "Apache-2.0";
  data.synthetic = true;
  data.files["drive.yaml"] = SettingsText(plan);
  const char* const of_orthosis[] = {"speed_05", "speed_10", "speed_20", "speed_10_20", "speed_20_10"};
  for (std::size_t i = 0; i < plan.trials.size(); ++i) {
    const std::string name = plan.orthosis ? of_orthosis[i] : SyntheticTrialName(i, plan.train);
    SINEW_ASSIGN(data.trials[name], RecordTrial(plan, i));
  }
  if (plan.exact) SINEW_TRY(MakeExact(plan.truth, plan.starts, data));
  SINEW_TRY(data.Check());
  return data;
}

Result<Dataset> SynthesizeDrive(const SynthesisRequest& request) {
  SINEW_ASSIGN(const DrivePlan plan, PlanDrive(request));
  return RecordDrive(plan);
}

std::vector<std::pair<std::string, std::string>> DriveExperiment() {
  return DescribeSettings(kSettings);
}

}  // namespace sinew
