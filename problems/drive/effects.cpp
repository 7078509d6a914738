#include "problems/drive/effects.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/constants.h"

namespace sinew {
namespace {

constexpr double kSlowest = 0.02;             // of the highest speed: the narrowest Stribeck peak
constexpr double kLongestDelay = 0.3;         // [s]
constexpr double kLongestSensingDelay = 0.1;  // [s]
constexpr double kMostRipples = 30;           // of a turn
constexpr double kSensorReach = 0.1;          // [s] of time offsets and low-passes

struct Units {
  std::string position, speed, torque, inertia, viscous, drag, stiffness, cubic_stiffness, compliance,
      per_torque, per_speed, torque_constant;
};

Units UnitsOf(bool rotary) {
  if (rotary) {
    return {"rad",     "rad/s",    "N*m",       "kg*m2",   "N*m*s/rad", "N*m*s2/rad2",
            "N*m/rad", "N*m/rad3", "rad/(N*m)", "1/(N*m)", "s/rad",     "N*m/A"};
  }
  return {"m", "m/s", "N", "kg", "N*s/m", "N*s2/m2", "N/m", "N/m3", "m/N", "1/N", "s/m", "N/A"};
}

// Periods from which a search leads to others from half a turn down to a thirtieth. Over a motion of a turn
// and more (the range of a linear axis is its turn) neighbours differ by at most one cycle, as far as the
// number of readings allows so many.
std::vector<double> RipplePeriods(double turn, const DriveScales& s) {
  constexpr double kCycles = 1;
  constexpr double kEntries = 1.5e6;  // readings times periods
  const std::vector<double> per_turn{2, 3, 4, 6, 8, 12, kMostRipples};
  const double most = std::clamp(kEntries / s.samples, 30.0, 300.0);
  const double spacing = std::max(kCycles * turn / s.position, (per_turn.back() - per_turn.front()) / most);
  std::vector<double> periods;
  for (std::size_t i = 0; i + 1 < per_turn.size(); ++i) {
    const double gap = per_turn[i + 1] - per_turn[i];
    const int parts = s.position < turn ? 1 : static_cast<int>(std::ceil(gap / spacing));
    for (int k = 0; k < parts; ++k) periods.push_back(turn / (per_turn[i] + gap * k / parts));
  }
  return periods;
}

// Also notes where a slot rests that has no parameter.
class Builder : public ParameterListBuilder {
 public:
  explicit Builder(DriveParameterList& list) : ParameterListBuilder(list, kDriveSlots), list_(list) {}

  void Base(DriveSlot slot, const char* name, const std::string& unit, const char* meaning, double lower,
            double upper, double start, Scale scale, const std::optional<double>& known,
            std::string below_lower = {}) {
    list_.resting[slot] = known.value_or(start);
    if (known) return;
    Parameter p = BaseParameter(name, unit, meaning, lower, upper, std::clamp(start, lower, upper));
    p.below_lower = std::move(below_lower);
    p.scale = scale;
    p.source = "equation of motion, drive.h";
    Add(std::move(p), slot);
  }

  void Term(DriveTerm term, const std::string& signal, const std::string& unit, double from, double to,
            double lower, double upper) {
    std::vector<double> knots;
    const int count = kTermKnots[static_cast<std::size_t>(term)];
    for (int k = 0; k < count; ++k) knots.push_back(from + (to - from) * k / (count - 1));
    ParameterListBuilder::Term(signal, unit, knots, lower, upper, "unknown " + list_.ports.back().name,
                               kTermSlots[static_cast<std::size_t>(term)]);
  }

 private:
  DriveParameterList& list_;
};

void AddBase(const DriveTraits& is, const DriveScales& s, const DriveStarts& start, const Units& unit,
             Builder& add) {
  // Of logarithmic ranges, both ways. Beside a known load the joint's own inertia is hard to guess; in a
  // closed loop the guess takes a lag for inertia.
  const double factor = is.load_known || is.controller != DriveControllerKind::kNone ? 30 : 10;
  constexpr double kFactor = 30;
  // A motor behind a gear may have several times the inertia of what it moves.
  constexpr double kMostOwnInertia = 10;
  const double inertia = start[kInertia];
  const double viscous = std::max(start[kViscousFriction], s.torque / s.speed);
  add.Base(kInertia, "inertia", unit.inertia, "moving inertia at the joint", inertia / factor,
           std::max(inertia * factor, kMostOwnInertia * is.load_inertia), inertia, Scale::kLog,
           is.fixed[kInertia]);
  add.Base(kViscousFriction, "viscous_friction", unit.viscous, "friction per speed", 0, 10 * viscous,
           start[kViscousFriction], Scale::kLinear, is.fixed[kViscousFriction]);
  const bool hangs = is.rotary && !is.load_known;
  const double gravity = std::max(std::abs(start[kGravityTorque]), s.torque);
  add.Base(kGravityTorque, "gravity_torque", unit.torque, "gravity torque of the horizontal load",
           -10 * gravity, 10 * gravity, hangs ? start[kGravityTorque] : 0, Scale::kLinear,
           hangs ? is.fixed[kGravityTorque] : std::optional(0.0));
  const bool gain = !is.electric && is.load_known && is.controller == DriveControllerKind::kNone;
  const double most_gain = 10 * (start[kDriveGain] > 0 ? start[kDriveGain] : 1);
  add.Base(
      kDriveGain, "drive_gain", "1", "torque per commanded torque", 0, most_gain, start[kDriveGain],
      Scale::kLinear, gain ? is.fixed[kDriveGain] : std::optional(is.fixed[kDriveGain].value_or(1)),
      is.input_channel +
          " would have to act backwards. Its sign, its unit or those of the position may be wrong, or much "
          "is missing in the model");
  const double constant = start[kTorqueConstant];
  add.Base(kTorqueConstant, "torque_constant", unit.torque_constant, "torque per current", constant / kFactor,
           constant * kFactor, constant, Scale::kLog,
           is.electric ? is.fixed[kTorqueConstant] : std::optional(1.0));
  const double resistance = start[kResistance];
  const bool has_resistance = is.electric && is.load_known;
  add.Base(kResistance, "resistance", "ohm", "resistance of the winding", resistance / kFactor,
           resistance * kFactor, resistance, Scale::kLog,
           has_resistance ? is.fixed[kResistance] : std::optional(is.fixed[kResistance].value_or(1)));
}

void AddDryFriction(const DriveScales& s, const Units& unit, Builder& add) {
  const char* const kBam = "Duclusaud et al. 2024";
  const char* const kArmstrong = "Armstrong-Helouvry et al. 1994";
  const std::vector<double> velocities{kSlowest * s.speed, 0.04 * s.speed, 0.1 * s.speed, 0.3 * s.speed,
                                       s.speed};
  add.BeginEffect("coulomb_friction", Level::kRobot,
                  "dry friction, equal in both directions, opposes the motion",
                  "slow reversals under small torques, where the joint sticks", kArmstrong)
      .Is(Occurrence::kCommon)
      .Positive(kCoulombTorque, "coulomb_torque", unit.torque, "dry friction", s.torque);
  add.BeginEffect("asymmetric_friction", Level::kRobot,
                  "dry friction differs between the directions of motion",
                  "the same slow motion forwards and backwards", kArmstrong)
      .Positive(kForwardFriction, "forward_friction", unit.torque, "dry friction of forward motion", s.torque)
      .Positive(kBackwardFriction, "backward_friction", unit.torque, "dry friction of backward motion",
                s.torque);
  add.BeginEffect("stribeck_friction", Level::kRobot, "dry friction is larger near standstill (Stribeck)",
                  "creeping at several constant, very low speeds", kArmstrong)
      .Is(Occurrence::kCommon)
      .Positive(kStribeckTorque, "stribeck_torque", unit.torque, "dry friction beyond that of fast motion",
                s.torque)
      .Number(kStribeckVelocity, "stribeck_velocity", unit.speed, "speed at which 1/e of it is left",
              kSlowest * s.speed, 2 * s.speed, 0.1 * s.speed)
      .Probes(velocities);
  add.BeginEffect("load_friction", Level::kRobot, "dry friction grows with the torque through the gear",
                  "the same slow motion with and without a weight, or swings over a wider range", kBam)
      .Positive(kLoadFriction, "load_friction_coefficient", "1", "dry friction per load of the gear", 1);
  add.BeginEffect("directional_friction", Level::kRobot,
                  "friction of the gear depends on whether motor or load drives it",
                  "lifting and lowering the same weight slowly, or swings over a wider range", kBam)
      .Positive(kMotorLoadFriction, "motor_load_friction", "1", "dry friction per drive torque", 1)
      .Positive(kExternalLoadFriction, "external_load_friction", "1", "dry friction per gravity torque", 1);
  add.BeginEffect("stribeck_load_friction", Level::kRobot,
                  "near standstill, dry friction grows with the torque through the gear",
                  "breaking away slowly under several weights, or swings over a wider range", kBam)
      .Is(Occurrence::kRare)
      .Positive(kStribeckLoad, "stribeck_load_coefficient", "1",
                "dry friction per load of the gear beyond that of fast motion", 1)
      .Number(kStribeckLoadVelocity, "stribeck_load_velocity", unit.speed, "speed at which 1/e of it is left",
              kSlowest * s.speed, 2 * s.speed, 0.1 * s.speed)
      .Probes(velocities);
  add.BeginEffect("quadratic_load_friction", Level::kRobot,
                  "dry friction grows with the square of the torque through the gear",
                  "the same slow motion under several weights, or swings over a wider range", kBam)
      .Is(Occurrence::kRare)
      .Positive(kQuadraticLoad, "quadratic_load_coefficient", unit.per_torque,
                "dry friction per squared load of the gear", 2 / s.torque);
}

void AddOtherTorques(const DriveTraits& is, const DriveScales& s, const Units& unit, Builder& add) {
  if (is.signals[kTemperature]) {
    add.BeginEffect("friction_with_temperature", Level::kRobot,
                    "viscous friction changes with the joint's temperature",
                    "the same motion with a cold joint and after an hour of work",
                    "Reynolds 1886; Bittencourt, Gunnarsson 2012")
        .Is(Occurrence::kRare)
        .TwoSided(kFrictionTemperature, "friction_temperature_coefficient", "1/K",
                  "c of viscous friction = viscous_friction exp(c (temperature - 293.15 K))", 0.1);
  }
  add.BeginEffect("asymmetric_viscous_friction", Level::kRobot,
                  "viscous friction differs between the directions of motion",
                  "the same fast motion forwards and backwards", "Armstrong-Helouvry et al. 1994")
      .Is(Occurrence::kRare)
      .TwoSided(kViscousAsymmetry, "viscous_asymmetry", unit.viscous,
                "viscous friction forwards, less the mean of both directions", 4 * s.torque / s.speed);
  add.BeginEffect("quadratic_drag", Level::kRobot, "friction grows with the square of the speed",
                  "constant speeds up to the highest")
      .Positive(kDrag, "drag_coefficient", unit.drag, "friction per squared speed",
                4 * s.torque / (s.speed * s.speed));
  // One turn of a rotary joint; the range of a linear axis.
  const double turn = is.rotary ? 2 * kPi : s.position;
  std::vector<double> periods = RipplePeriods(turn, s);
  double shortest = turn / kMostRipples;
  if (is.pole_period) {
    periods.push_back(*is.pole_period);
    shortest = std::min(shortest, 0.5 * *is.pole_period);
  }
  // A ripple with one period per turn is the gravity torque of a load that hangs.
  const bool hangs = is.rotary && !is.load_known;
  const double longest = hangs ? turn / 1.5 : turn;
  add.BeginEffect("cogging", Level::kRobot, "the drive's torque ripples with position",
                  "holding many positions over the whole range at rest")
      .TwoSided(kCoggingCos, "cogging_cos", unit.torque, "ripple, in phase with the position's cosine",
                s.torque)
      .TwoSided(kCoggingSin, "cogging_sin", unit.torque, "ripple, in phase with the position's sine",
                s.torque)
      .Number(kCoggingPeriod, "cogging_period", unit.position, "period of the ripple", shortest, longest,
              turn / 6)
      .Probes(periods);
  // In open loop the record holds what was left for the drive to do: what does not move by itself may be
  // larger, as a stretched spring at position 0 whose torque is small where the motion was. Behind a
  // controller the drive holds it, with what its largest command gives.
  const bool open_loop = is.controller == DriveControllerKind::kNone;
  const double passive = (open_loop ? 4 : 1) * s.torque;
  const double elastic = (open_loop ? 4 : 2) * s.torque;  // at half the width of the range
  if (is.rotary) {
    add.BeginEffect("gravity_imbalance", Level::kRobot, "the load does not hang straight down at position 0",
                    "holding several positions at rest, one of them an angle that is known by other means")
        .TwoSided(kImbalance, "imbalance_torque", unit.torque, "gravity torque at position 0", passive);
  }
  if (is.fixed[kInertia]) {
    add.BeginEffect("inertia_error", Level::kRobot, "the moving inertia differs from the stated one",
                    "fast accelerations with a known torque")
        .Is(Occurrence::kRare)
        .TwoSided(kInertiaError, "inertia_error", unit.inertia, "inertia beyond the stated one",
                  0.9 * *is.fixed[kInertia]);
  }
  add.BeginEffect("parallel_spring", Level::kRobot,
                  "an elastic element acts in parallel, with its rest at position 0",
                  "motion over a wider range of positions")
      .Is(Occurrence::kRare)
      .Positive(kSpring, "spring_stiffness", unit.stiffness, "torque per position",
                elastic / (0.5 * s.position));
  add.BeginEffect("stiffening_spring", Level::kRobot,
                  "an elastic element acts in parallel whose torque grows with the cube of the position",
                  "motion over a wider range of positions, to both ends")
      .Is(Occurrence::kRare)
      .TwoSided(kCubicStiffness, "cubic_stiffness", unit.cubic_stiffness,
                "torque per cubed position; negative: it softens", elastic / std::pow(0.5 * s.position, 3));
  add.BeginEffect("torque_offset", Level::kRobot, "a constant torque acts besides the drive's",
                  "holding several positions at rest, and a rest with the drive switched off")
      .Is(Occurrence::kCommon)
      .TwoSided(kOffsetTorque, "offset_torque", unit.torque, "constant torque", passive);
}

void AddDrive(const DriveTraits& is, const DriveScales& s, const Units& unit, Builder& add) {
  const std::string command_unit = is.controller == DriveControllerKind::kNone    ? is.input_unit
                                   : is.controller == DriveControllerKind::kServo ? "1"
                                   : is.electric                                  ? "V"
                                                                                  : unit.torque;
  add.BeginEffect("dead_zone", Level::kRobot, "small commands have no effect; of larger ones the excess acts",
                  "small commands of both signs, held, about a position without load", "Tao & Kokotovic 1996")
      .Positive(kDeadZone, "dead_zone_width", command_unit, "largest command without effect",
                0.5 * s.motor_command);
  add.BeginEffect("torque_saturation", Level::kRobot, "the drive's torque is limited",
                  "large commands against a fixed stop")
      .Positive(kInverseTorqueLimit, "inverse_torque_limit", unit.per_torque, "1 / largest torque",
                5 / s.torque)
      .Probes({1 / (0.95 * s.torque), 1 / (0.85 * s.torque), 1 / (0.7 * s.torque), 1 / (0.5 * s.torque)});
  add.BeginEffect("speed_saturation", Level::kRobot, "the drive loses its torque near a highest speed",
                  "large commands without a load")
      .Is(Occurrence::kRare)
      .Positive(kInverseSpeedLimit, "inverse_speed_limit", unit.per_speed, "1 / highest speed", 2.5 / s.speed)
      .Probes({1 / (0.95 * s.speed), 1 / (0.85 * s.speed), 1 / (0.7 * s.speed), 1 / (0.5 * s.speed)});
  if (is.compressible) {
    add.BeginEffect("gain_compression", Level::kRobot, "the drive's gain is smaller at large commands",
                    "commands of several sizes at rest against a torque sensor")
        .Positive(kCompression, "compression", "1", "share lost at the largest command", 0.9);
  }
  add.BeginEffect("supply_sag", Level::kRobot,
                  "the drive's gain changes with time (supply voltage, temperature of the motor)",
                  "the same motion at the begin and at the end of a long trial")
      .TwoSided(kThermalRate, "thermal_rate", "1/s", "share of the gain lost per second; negative: gained",
                0.9 / s.duration);
  add.BeginEffect("gain_warm_up", Level::kRobot,
                  "the drive's gain settles from the begin of each trial to its final value",
                  "the same motion again and again from a cold start")
      .Is(Occurrence::kRare)
      .TwoSided(kWarmUpGain, "warm_up_gain", "1",
                "share of the initial gain gained in the end; negative: lost", 0.9)
      .Number(kWarmUpTime, "warm_up_time", "s", "time after which 1/e of the change is left",
              0.01 * s.duration, 0.5 * s.duration, 0.2 * s.duration)
      .Probes({0.05 * s.duration, 0.1 * s.duration, 0.2 * s.duration, 0.4 * s.duration});
  if (is.session) {
    add.BeginEffect("gain_over_session", Level::kRobot,
                    "the drive's gain changes over the session, from trial to trial",
                    "the same motion in the first and in the last trial of a session")
        .TwoSided(kSessionRate, "session_rate", "1/s",
                  "share of the gain at the begin of the session gained per second; negative: lost",
                  0.9 / s.session);
  }
  if (is.electric) {
    add.BeginEffect("winding_warms", Level::kRobot,
                    "the resistance of the winding changes with time (it warms up)",
                    "a measured current at the begin and at the end of a long trial")
        .TwoSided(kResistanceRate, "resistance_rate", "1/s", "share of the resistance gained per second",
                  0.9 / s.duration);
  }
  add.BeginEffect("command_delay", Level::kRobot, "the drive responds to its command with a delay",
                  "a trigger that all instruments record, then one sharp command, at a high sampling rate")
      .Is(Occurrence::kCommon)
      .Positive(kCommandDelay, "command_delay", "s", "age of the command that acts",
                std::min(kLongestDelay, 0.25 * s.shortest));
  if (is.controller != DriveControllerKind::kNone) {
    add.BeginEffect("sensing_delay", Level::kRobot, "the controller's feedback is delayed",
                    "a step of the reference with a stiff controller, near its stability limit")
        .Positive(kSensingDelay, "sensing_delay", "s", "age of the feedback", kLongestSensingDelay);
    add.BeginEffect("actuation_delay", Level::kRobot, "the controller's output acts with a delay",
                    "a step of the reference against a fixed stop, with the drive's torque recorded")
        .Is(Occurrence::kCommon)
        .Positive(kActuationDelay, "actuation_delay", "s", "age of the output that acts",
                  kLongestSensingDelay);
  }
  if (!is.held) {
    add.BeginEffect("hold", Level::kRobot,
                    "the command is held between its samples, not straight between them",
                    "fast commands recorded much faster than they are sent")
        .Is(Occurrence::kRare)
        .Positive(kHoldFraction, "hold_fraction", "1", "0: straight, 1: held", 1);
  }
  add.BeginEffect("backlash", Level::kRobot, "the position reading has play against the joint",
                  "slow reversals with sensors on both sides of the gear", "Tao & Kokotovic 1996")
      .Is(Occurrence::kCommon)
      .Positive(kBacklash, "backlash_width", unit.position, "total gap", 0.25 * s.position)
      .NullStep(2 * s.noise);
  add.BeginEffect("compliance", Level::kRobot,
                  "the transmission winds up under torque, seen on the motor's side",
                  "torque against a fixed stop")
      .Positive(kCompliance, "transmission_compliance", unit.compliance, "wind-up per torque",
                0.5 * s.position / s.torque);
}

void AddInputSensor(const DriveTraits& is, const DriveScales& s, Builder& add) {
  const std::string& channel = is.input_channel;
  const auto name = [&](const char* kind, const std::string& description,
                        const std::string& experiment) -> ParameterListBuilder& {
    return add.BeginEffect(channel + "." + kind, Level::kSensor, channel + ": " + description, experiment);
  };
  name("offset", "the recorded input is too large by a constant",
       "holding several positions at rest, one of them with an input that is known by other means")
      .Is(Occurrence::kCommon)
      .TwoSided(kInputOffset, channel + ".offset", is.input_unit, "constant error of the recorded input",
                s.command);
  name("gain", "the recorded input is too large by a factor", "a known input")
      .Number(kInputGain, channel + ".gain", "1", "recorded per true input", 0.1, 1.9, 1);
  name("drift", "the recorded input drifts with time",
       "holding several positions at rest, at the begin and at the end of a long trial")
      .Is(Occurrence::kRare)
      .TwoSided(kInputDrift, channel + ".drift", is.input_unit + "/s", "growth of the input's error",
                s.command / s.duration);
  name("time_offset", "the input's clock is late against the other instruments",
       "a trigger that all instruments record, at a high sampling rate")
      .TwoSided(kInputTimeOffset, channel + ".time_offset", "s", "age of the recorded input", kSensorReach);
  name("low_pass", "the recorded input was smoothed by a first-order low-pass",
       "a sharp input, recorded before and after the filter")
      .Is(Occurrence::kRare)
      .Positive(kInputLowPass, channel + ".low_pass", "s", "time constant of the smoothing", kSensorReach);
}

}  // namespace

DriveParameterList ListDriveParameters(const DriveTraits& is, const DriveScales& s,
                                       const DriveStarts& starts) {
  DriveParameterList list;
  const Units unit = UnitsOf(is.rotary);
  Builder add(list);
  AddBase(is, s, starts, unit, add);
  AddDryFriction(s, unit, add);
  AddOtherTorques(is, s, unit, add);
  AddDrive(is, s, unit, add);
  AddInputSensor(is, s, add);
  const std::string push = is.rotary ? "torque" : "force";
  add.BeginPort(push, unit.torque, "an unknown " + push + " acts on the joint");
  add.Term(kTorqueOfPosition, "position", unit.position, s.lowest, s.highest, -s.torque, s.torque);
  add.Term(kTorqueOfVelocity, "velocity", unit.speed, -s.speed, s.speed, -s.torque, s.torque);
  add.Term(kTorqueOfCommand, "command", is.input_unit, s.lowest_command, s.highest_command, -s.torque,
           s.torque);
  add.Term(kTorqueOfTime, "time", "s", 0, s.duration, -s.torque, s.torque);
  // A curve of one signal is no product of two: friction that changes opposes motion both ways. Small ones
  // show as a drift of viscous_friction or as other curves.
  add.BeginPort("friction", unit.torque, "unknown dry friction acts on the joint");
  add.Term(kFrictionOfPosition, "position", unit.position, s.lowest, s.highest, 0, s.torque);
  add.Term(kFrictionOfTime, "time", "s", 0, s.duration, 0, s.torque);
  add.BeginPort("damping", unit.viscous, "the viscous friction changes");
  add.Term(kDampingOfTime, "time", "s", 0, s.duration, -s.torque / s.speed, s.torque / s.speed);
  for (std::size_t port = 1; port < list.ports.size(); ++port) {
    for (DiscrepancyTerm& term : list.ports[port].terms) term.beside_causes = true;
  }
  // Numbers that must not be zero where their effect does not exist.
  list.resting[kInputGain] = 1;
  list.resting[kCoggingPeriod] = 1;
  list.resting[kWarmUpTime] = 1;
  return list;
}

}  // namespace sinew
