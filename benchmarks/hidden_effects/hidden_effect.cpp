#include "benchmarks/hidden_effects/hidden_effect.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace sinew {
namespace {

constexpr double kPi = 3.14159265358979323846;

using Member = double DriveTruth::*;

// Effects that are one number with a null: name, member, guess, most, two-sided.
struct Plain {
  Member member;
  double guess;
  double most;
  bool two_sided;
  double null = 0;
};

const std::map<std::string, Plain>& PlainEffects() {
  using T = DriveTruth;
  static const std::map<std::string, Plain> kPlain{
      {"coulomb_friction", {&T::coulomb_torque, 1e-3, 10, false}},
      {"load_friction", {&T::load_friction_coefficient, 1e-3, 1, false}},
      {"quadratic_load_friction", {&T::quadratic_load_coefficient, 1e-3, 10, false}},
      {"quadratic_drag", {&T::drag_coefficient, 1e-3, 10, false}},
      {"backlash", {&T::backlash_width, 1e-3, 0.5, false}},
      {"compliance", {&T::transmission_compliance, 1e-3, 0.5, false}},
      {"command_delay", {&T::command_delay, 1e-3, 0.25, false}},
      {"gravity_imbalance", {&T::imbalance_torque, 1e-3, 5, true}},
      {"parallel_spring", {&T::spring_stiffness, 1e-3, 20, false}},
      {"torque_offset", {&T::offset_torque, 1e-3, 5, true}},
      {"gain_compression", {&T::compression, 1e-3, 0.9, false}},
      {"supply_sag", {&T::thermal_rate, 1e-4, 0.08, false}},
      {"hold", {&T::hold_fraction, 0.1, 1, false}},
      {"torque.offset", {&T::input_offset, 1e-3, 5, true}},
      {"torque.drift", {&T::input_drift, 1e-4, 1, true}},
      {"torque.time_offset", {&T::input_time_offset, 1e-3, 0.1, true}},
      {"torque.low_pass", {&T::input_low_pass, 1e-3, 0.5, false}},
      {"position.offset", {&T::position_offset, 1e-3, 2, true}},
      {"position.drift", {&T::position_drift, 1e-4, 0.2, true}},
      {"position.gain", {&T::position_gain, 1e-3, 0.8, true, 1}},
      {"position.time_offset", {&T::position_time_offset, 1e-3, 0.1, true}},
      {"position.low_pass", {&T::position_low_pass, 1e-3, 0.5, false}},
      {"position.quantisation", {&T::position_quantisation, 1e-3, 0.3, false}},
      {"wear", {&T::wear_rate, 1e-4, 1, false}},
      {"shifting_mass", {&T::shift_rate, 1e-4, 0.05, true}},
      {"slow_clock", {&T::clock_rate, 1e-5, 9e-3, true}},
      {"drifting_damping", {&T::damping_rate, 1e-4, 1, false}},
      {"cubic_spring", {&T::cubic_stiffness, 1e-3, 10, false}},
      {"dead_zone", {&T::dead_torque, 1e-3, 1, false}},
      {"cubic_drag", {&T::cubic_drag, 1e-4, 10, false}},
  };
  return kPlain;
}

HiddenEffect MakePlain(const std::string& name, const Plain& plain, double sign) {
  const auto apply = [plain, sign](double a, DriveTruth& truth) {
    truth.*plain.member = plain.null + sign * a;
  };
  return {name, apply, plain.guess, plain.most};
}

// An amplitude times fixed weights, other members at fixed values while the amplitude is not zero.
HiddenEffect MakeWeighted(const std::string& name, const std::vector<std::pair<Member, double>>& weights,
                          const std::vector<std::pair<Member, double>>& fixed, double guess, double most) {
  const auto apply = [weights, fixed](double a, DriveTruth& truth) {
    for (const auto& [member, value] : fixed) truth.*member = value;
    for (const auto& [member, weight] : weights) truth.*member = weight * a;
  };
  return {name, apply, guess, most};
}

// The amplitude is the share of the largest magnitude that is cut off.
HiddenEffect MakeLimit(const std::string& name, Member inverse_limit, double largest) {
  const auto apply = [inverse_limit, largest](double a, DriveTruth& truth) {
    truth.*inverse_limit = a > 0 ? 1 / (largest * (1 - a)) : 0;
  };
  return {name, apply, 0.02, 0.6};
}

double LogUniform(double lower, double upper, Random& random) {
  return lower * std::pow(upper / lower, random.Uniform());
}

HiddenEffect Cogging(double period, double phase) {
  return MakeWeighted(
      "cogging", {{&DriveTruth::cogging_cos, std::cos(phase)}, {&DriveTruth::cogging_sin, std::sin(phase)}},
      {{&DriveTruth::cogging_period, period}}, 1e-3, 5);
}

HiddenEffect Stribeck(double velocity) {
  return MakeWeighted("stribeck_friction", {{&DriveTruth::stribeck_torque, 1}},
                      {{&DriveTruth::stribeck_velocity, velocity}}, 1e-3, 10);
}

HiddenEffect StribeckLoad(double velocity) {
  return MakeWeighted("stribeck_load_friction", {{&DriveTruth::stribeck_load_coefficient, 1}},
                      {{&DriveTruth::stribeck_load_velocity, velocity}}, 1e-3, 5);
}

HiddenEffect Asymmetric(double forward, double backward) {
  return MakeWeighted("asymmetric_friction",
                      {{&DriveTruth::forward_friction, forward}, {&DriveTruth::backward_friction, backward}},
                      {}, 1e-3, 10);
}

HiddenEffect Directional(double motor, double external) {
  return MakeWeighted(
      "directional_friction",
      {{&DriveTruth::motor_load_friction, motor}, {&DriveTruth::external_load_friction, external}}, {}, 1e-3,
      1);
}

HiddenEffect TorqueSaturation(const Extents& extents) {
  return MakeLimit("torque_saturation", &DriveTruth::inverse_torque_limit, extents.torque);
}

// The torque falls from 0.9 of the limit on.
HiddenEffect SpeedSaturation(const Extents& extents) {
  return MakeLimit("speed_saturation", &DriveTruth::inverse_speed_limit, extents.speed / 0.9);
}

HiddenEffect PositionSaturation(const Extents& extents) {
  return MakeLimit("position.saturation", &DriveTruth::position_saturation, extents.position);
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
                                               "position.quantisation"};
  return kNames;
}

const std::vector<std::string>& OutsiderNames() {
  static const std::vector<std::string> kNames{"wear",
                                               "tight_spot",
                                               "shifting_mass",
                                               "hysteretic_spring",
                                               "slow_clock",
                                               "drifting_damping",
                                               "cubic_spring",
                                               "hum",
                                               "torque_bump",
                                               "dead_zone",
                                               "lost_load",
                                               "cubic_drag",
                                               "eccentric_encoder"};
  return kNames;
}

HiddenEffect DrawHidden(const std::string& name, const Extents& extents, Random& random) {
  using T = DriveTruth;
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
  if (name == "torque_saturation") return TorqueSaturation(extents);
  if (name == "speed_saturation") return SpeedSaturation(extents);
  if (name == "position.saturation") return PositionSaturation(extents);
  if (name == "tight_spot") {
    const double at = inside();
    return MakeWeighted(name, {{&T::tight_spot_torque, 1}},
                        {{&T::tight_spot_position, at}, {&T::tight_spot_width, random.Uniform(0.1, 0.4)}},
                        1e-3, 10);
  }
  if (name == "hysteretic_spring") {
    return MakeWeighted(name, {{&T::hysteresis_torque, 1}},
                        {{&T::hysteresis_width, random.Uniform(0.2, 0.6)}}, 1e-3, 10);
  }
  if (name == "hum") {
    const double frequency = LogUniform(0.5, 5, random);
    return MakeWeighted(name, {{&T::hum_torque, 1}},
                        {{&T::hum_frequency, frequency}, {&T::hum_phase, random.Uniform(0, 2 * kPi)}}, 1e-3,
                        5);
  }
  if (name == "torque_bump") {
    const double sign = random.Uniform() < 0.5 ? -1 : 1;
    const double at = inside();
    return MakeWeighted(name, {{&T::bump_torque, sign}},
                        {{&T::bump_position, at}, {&T::bump_width, random.Uniform(0.05, 0.2)}}, 1e-3, 5);
  }
  if (name == "lost_load") {
    return MakeWeighted(name, {{&T::lost_load, 1}}, {{&T::lost_time, random.Uniform(3, 7)}}, 1e-3, 0.8);
  }
  // eccentric_encoder
  return MakeWeighted(name, {{&T::eccentricity, 1}}, {{&T::eccentricity_phase, random.Uniform(0, 2 * kPi)}},
                      1e-3, 0.3);
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
  for (const double share : {0.02, 0.06, 0.2}) {
    groups.push_back({name == "stribeck_friction" ? Stribeck(share * extents.speed)
                                                  : StribeckLoad(share * extents.speed)});
  }
  return groups;
}

}  // namespace sinew
