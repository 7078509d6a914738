#include "benchmarks/hidden_effects/hidden_effect.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace sinew {
namespace {

using Member = int;  // a slot of DriveTruth

// Effects that are one number with a null: name, member, guess, most, two-sided.
struct Plain {
  Member member;
  double guess;
  double most;
  bool two_sided;
  double null = 0;
};

const std::map<std::string, Plain>& PlainEffects() {
  static const std::map<std::string, Plain> kPlain{
      {"coulomb_friction", {kCoulombTorque, 1e-3, 10, false}},
      {"load_friction", {kLoadFriction, 1e-3, 1, false}},
      {"quadratic_load_friction", {kQuadraticLoad, 1e-3, 10, false}},
      {"quadratic_drag", {kDrag, 1e-3, 10, false}},
      {"backlash", {kBacklash, 1e-3, 0.5, false}},
      {"compliance", {kCompliance, 1e-3, 0.5, false}},
      {"command_delay", {kCommandDelay, 1e-3, 0.25, false}},
      {"actuation_delay", {kActuationDelay, 1e-3, 0.1, false}},
      {"gravity_imbalance", {kImbalance, 1e-3, 5, true}},
      {"parallel_spring", {kSpring, 1e-3, 20, false}},
      {"stiffening_spring", {kCubicStiffness, 1e-3, 10, true}},
      {"torque_offset", {kOffsetTorque, 1e-3, 5, true}},
      {"gain_compression", {kCompression, 1e-3, 0.9, false}},
      {"supply_sag", {kThermalRate, 1e-4, 0.08, true}},
      {"dead_zone", {kDeadZone, 1e-3, 1, false}},
      {"asymmetric_viscous_friction", {kViscousAsymmetry, 1e-4, 5, true}},
      {"hold", {kHoldFraction, 0.1, 1, false}},
      {"torque.offset", {kInputOffset, 1e-3, 5, true}},
      {"torque.drift", {kInputDrift, 1e-4, 1, true}},
      {"torque.time_offset", {kInputTimeOffset, 1e-3, 0.1, true}},
      {"torque.low_pass", {kInputLowPass, 1e-3, 0.5, false}},
      {"position.offset", {kPositionOffset, 1e-3, 2, true}},
      {"position.drift", {kPositionDrift, 1e-4, 0.2, true}},
      {"position.gain", {kPositionGain, 1e-3, 0.8, true, 1}},
      {"position.time_offset", {kPositionTimeOffset, 1e-3, 0.1, true}},
      {"position.low_pass", {kPositionLowPass, 1e-3, 0.5, false}},
      {"position.quantisation", {kPositionQuantisation, 1e-3, 0.3, false}},
      {"wear", {kWearRate, 1e-4, 1, false}},
      {"shifting_mass", {kShiftRate, 1e-4, 0.05, true}},
      {"slow_clock", {kClockRate, 1e-5, 9e-3, true}},
      {"drifting_damping", {kDampingRate, 1e-4, 1, false}},
      {"coarse_command", {kCommandStep, 1e-2, 2, false}},
      {"cubic_drag", {kCubicDrag, 1e-4, 10, false}},
  };
  return kPlain;
}

HiddenEffect MakePlain(const std::string& name, const Plain& plain, double sign) {
  const auto apply = [plain, sign](double a, DriveTruth& truth) {
    truth[plain.member] = plain.null + sign * a;
  };
  return {name, apply, plain.guess, plain.most};
}

// An amplitude times fixed weights, other members at fixed values while the amplitude is not zero.
HiddenEffect MakeWeighted(const std::string& name, const std::vector<std::pair<Member, double>>& weights,
                          const std::vector<std::pair<Member, double>>& fixed, double guess, double most) {
  const auto apply = [weights, fixed](double a, DriveTruth& truth) {
    for (const auto& [member, value] : fixed) truth[member] = value;
    for (const auto& [member, weight] : weights) truth[member] = weight * a;
  };
  return {name, apply, guess, most};
}

// The amplitude is the share of the largest magnitude that is cut off.
HiddenEffect MakeLimit(const std::string& name, Member inverse_limit, double largest) {
  const auto apply = [inverse_limit, largest](double a, DriveTruth& truth) {
    truth[inverse_limit] = a > 0 ? 1 / (largest * (1 - a)) : 0;
  };
  return {name, apply, 0.02, 0.6};
}

double LogUniform(double lower, double upper, Random& random) {
  return lower * std::pow(upper / lower, random.Uniform());
}

HiddenEffect Cogging(double period, double phase) {
  return MakeWeighted("cogging", {{kCoggingCos, std::cos(phase)}, {kCoggingSin, std::sin(phase)}},
                      {{kCoggingPeriod, period}}, 1e-3, 5);
}

HiddenEffect Stribeck(double velocity) {
  return MakeWeighted("stribeck_friction", {{kStribeckTorque, 1}}, {{kStribeckVelocity, velocity}}, 1e-3, 10);
}

HiddenEffect StribeckLoad(double velocity) {
  return MakeWeighted("stribeck_load_friction", {{kStribeckLoad, 1}}, {{kStribeckLoadVelocity, velocity}},
                      1e-3, 5);
}

HiddenEffect Asymmetric(double forward, double backward) {
  return MakeWeighted("asymmetric_friction", {{kForwardFriction, forward}, {kBackwardFriction, backward}}, {},
                      1e-3, 10);
}

HiddenEffect Directional(double motor, double external) {
  return MakeWeighted("directional_friction",
                      {{kMotorLoadFriction, motor}, {kExternalLoadFriction, external}}, {}, 1e-3, 1);
}

HiddenEffect WarmUp(double time, double sign) {
  return MakeWeighted("gain_warm_up", {{kWarmUpGain, sign}}, {{kWarmUpTime, time}}, 1e-3, 0.8);
}

HiddenEffect TorqueSaturation(const Extents& extents) {
  return MakeLimit("torque_saturation", kInverseTorqueLimit, extents.torque);
}

// The torque falls from 0.9 of the limit on.
HiddenEffect SpeedSaturation(const Extents& extents) {
  return MakeLimit("speed_saturation", kInverseSpeedLimit, extents.speed / 0.9);
}

HiddenEffect PositionSaturation(const Extents& extents) {
  return MakeLimit("position.saturation", kPositionSaturation, extents.position);
}

}  // namespace

const std::vector<std::string>& LibraryEffects() {
  static const std::vector<std::string> kNames{"coulomb_friction",
                                               "asymmetric_friction",
                                               "stribeck_friction",
                                               "load_friction",
                                               "directional_friction",
                                               "stribeck_load_friction",
                                               "quadratic_load_friction",
                                               "quadratic_drag",
                                               "backlash",
                                               "compliance",
                                               "command_delay",
                                               "torque_saturation",
                                               "speed_saturation",
                                               "cogging",
                                               "gravity_imbalance",
                                               "parallel_spring",
                                               "torque_offset",
                                               "gain_compression",
                                               "supply_sag",
                                               "gain_warm_up",
                                               "dead_zone",
                                               "asymmetric_viscous_friction",
                                               "hold",
                                               "torque.offset",
                                               "torque.drift",
                                               "torque.time_offset",
                                               "torque.low_pass",
                                               "position.offset",
                                               "position.drift",
                                               "position.gain",
                                               "position.time_offset",
                                               "position.low_pass",
                                               "position.saturation",
                                               "position.quantisation",
                                               "stiffening_spring"};
  return kNames;
}

const std::vector<std::string>& OutsiderNames() {
  static const std::vector<std::string> kNames{"wear",
                                               "tight_spot",
                                               "shifting_mass",
                                               "hysteretic_spring",
                                               "slow_clock",
                                               "drifting_damping",
                                               "end_stop",
                                               "hum",
                                               "torque_bump",
                                               "coarse_command",
                                               "lost_load",
                                               "cubic_drag",
                                               "eccentric_encoder"};
  return kNames;
}

HiddenEffect DrawHidden(const std::string& name, const Extents& extents, Random& random) {
  const auto plain = PlainEffects().find(name);
  if (plain != PlainEffects().end()) {
    const double sign = plain->second.two_sided && random.Uniform() < 0.5 ? -1 : 1;
    return MakePlain(name, plain->second, sign);
  }
  const auto inside = [&] { return random.Uniform(-0.6, 0.6) * extents.position; };
  if (name == "asymmetric_friction" || name == "directional_friction") {
    const double less = random.Uniform(0, 0.6);
    const bool first = random.Uniform() < 0.5;
    return name == "asymmetric_friction" ? Asymmetric(first ? 1 : less, first ? less : 1)
                                         : Directional(first ? 1 : less, first ? less : 1);
  }
  if (name == "stribeck_friction") return Stribeck(LogUniform(0.02, 0.3, random) * extents.speed);
  if (name == "stribeck_load_friction") return StribeckLoad(LogUniform(0.02, 0.3, random) * extents.speed);
  if (name == "cogging") {
    const double period = LogUniform(2 * kPi / 13, 2 * kPi / 1.8, random);
    return Cogging(period, random.Uniform(0, 2 * kPi));
  }
  if (name == "gain_warm_up") {
    const double sign = random.Uniform() < 0.5 ? -1 : 1;
    return WarmUp(LogUniform(0.5, 4, random), sign);
  }
  if (name == "torque_saturation") return TorqueSaturation(extents);
  if (name == "speed_saturation") return SpeedSaturation(extents);
  if (name == "position.saturation") return PositionSaturation(extents);
  if (name == "tight_spot") {
    const double at = inside();
    return MakeWeighted(name, {{kTightSpotTorque, 1}},
                        {{kTightSpotPosition, at}, {kTightSpotWidth, random.Uniform(0.1, 0.4)}}, 1e-3, 10);
  }
  if (name == "hysteretic_spring") {
    return MakeWeighted(name, {{kHysteresisTorque, 1}}, {{kHysteresisWidth, random.Uniform(0.2, 0.6)}}, 1e-3,
                        10);
  }
  if (name == "end_stop") {
    return MakeWeighted(name, {{kStopStiffness, 1}},
                        {{kStopPosition, random.Uniform(0.1, 0.6) * extents.position}}, 1e-3, 100);
  }
  if (name == "hum") {
    const double frequency = LogUniform(0.5, 5, random);
    return MakeWeighted(name, {{kHumTorque, 1}},
                        {{kHumFrequency, frequency}, {kHumPhase, random.Uniform(0, 2 * kPi)}}, 1e-3, 5);
  }
  if (name == "torque_bump") {
    const double sign = random.Uniform() < 0.5 ? -1 : 1;
    const double at = inside();
    return MakeWeighted(name, {{kBumpTorque, sign}},
                        {{kBumpPosition, at}, {kBumpWidth, random.Uniform(0.05, 0.2)}}, 1e-3, 5);
  }
  if (name == "lost_load") {
    return MakeWeighted(name, {{kLostLoad, 1}}, {{kLostTime, random.Uniform(3, 7)}}, 1e-3, 0.8);
  }
  // eccentric_encoder
  return MakeWeighted(name, {{kEccentricity, 1}}, {{kEccentricityPhase, random.Uniform(0, 2 * kPi)}}, 1e-3,
                      0.3);
}

std::vector<std::vector<HiddenEffect>> CandidateColumns(const std::string& name, const Extents& extents) {
  const auto plain = PlainEffects().find(name);
  if (plain != PlainEffects().end()) return {{MakePlain(name, plain->second, 1)}};
  if (name == "asymmetric_friction") return {{Asymmetric(1, 0), Asymmetric(0, 1)}};
  if (name == "directional_friction") return {{Directional(1, 0), Directional(0, 1)}};
  if (name == "torque_saturation") return {{TorqueSaturation(extents)}};
  if (name == "speed_saturation") return {{SpeedSaturation(extents)}};
  if (name == "position.saturation") return {{PositionSaturation(extents)}};
  std::vector<std::vector<HiddenEffect>> groups;
  if (name == "cogging") {
    for (const int n : {2, 3, 4, 6, 8, 12}) {
      groups.push_back({Cogging(2 * kPi / n, 0), Cogging(2 * kPi / n, kPi / 2)});
    }
    return groups;
  }
  if (name == "gain_warm_up") {
    for (const double time : {0.5, 1.0, 2.0, 4.0}) groups.push_back({WarmUp(time, 1)});
    return groups;
  }
  for (const double share : {0.02, 0.06, 0.2}) {
    groups.push_back({name == "stribeck_friction" ? Stribeck(share * extents.speed)
                                                  : StribeckLoad(share * extents.speed)});
  }
  return groups;
}

}  // namespace sinew
