// The laboratory's own simulation: its energy, and against the fitted model.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "base/constants.h"
#include "problems/ankle_on_dynamometer/laboratory/simulation.h"
#include "problems/ankle_on_dynamometer/laboratory/synthesis.h"
#include "tests/problems/ankle_on_dynamometer/ankle_bench.h"

namespace sinew {
namespace {

constexpr double kDegree = kPi / 180;

// Every effect that stores or loses energy is there.
StrappedFoot<double> TruePerson(const AnkleSettings& settings) {
  std::vector<double> values = AnkleDefaults(settings);
  const auto set = [&](int slot, double value) { values[static_cast<std::size_t>(slot)] = value; };
  set(kAttachmentInertia, 0.08);
  set(kDryFriction, 0.5);
  set(kFrictionWithLoad, 0.02);
  set(kAttachmentStiffness, 3);
  set(kAxisX, 0.01);
  set(kAxisY, -0.008);
  set(kSoleExponent, 0.2);
  set(kBoundaryRelaxation, 30);
  set(kBoundaryRelaxationTime, 0.3);
  set(kPassiveHysteresis, 0.5);
  set(kPassiveRelaxation, 10);
  set(kPassiveRelaxationTime, 0.4);
  return FootOf(settings, values);
}

struct EnergyBalance {
  double motor = 0;  // work [J]
  double muscles = 0;
  double lost = 0;
  double change = 0;     // of the stored energy
  double exchanged = 0;  // integral of the absolute powers
  double range = 0;      // of the plate [rad]
  double fastest = 0;    // plate [rad/s]

  [[nodiscard]] double error() const { return std::abs(motor + muscles - change - lost) / exchanged; }
};

// Over a cycle of contractions of 1.6 s, after a first one.
EnergyBalance Balance(const MachineProgram& program) {
  const AnkleSettings settings = AnkleBenchSettings();
  std::vector<MusclePath> paths;
  for (const AnkleMuscle& muscle : settings.muscles) paths.push_back(muscle.path);
  constexpr double kCycle = 1.6;
  LaboratoryTrial trial;
  trial.program = program;
  trial.duration = 2 * kCycle;
  trial.activation = [](double t, std::vector<double>& activations) {
    const double phase = 2 * kPi * t / kCycle;
    activations = {0.25 * (1 - std::cos(phase)), 0.2 * (1 + std::cos(phase)), 0};
  };
  EnergyBalance sum;
  LaboratoryInstant before;
  bool any = false;
  double first = 0;
  double least = 1;
  double most = -1;
  // Simpson's rule would see the corners of the contact; trapezia of 0.1 ms are fine enough.
  const auto add = [&](double& work, double power, double earlier) {
    work += 0.5e-4 * (power + earlier);
    sum.exchanged += 0.5e-4 * (std::abs(power) + std::abs(earlier));
  };
  const auto status = SimulateLaboratory(settings.foot, MuscleCurves::Default(), paths, TruePerson(settings),
                                         trial, 1e-4, [&](const LaboratoryInstant& now) {
                                           if (now.time < kCycle - 1e-9) return;
                                           if (any) {
                                             add(sum.motor, now.motor_torque * now.plate_velocity,
                                                 before.motor_torque * before.plate_velocity);
                                             add(sum.muscles, now.muscle_power, before.muscle_power);
                                             add(sum.lost, now.lost_power, before.lost_power);
                                           } else {
                                             first = now.energy;
                                           }
                                           any = true;
                                           before = now;
                                           sum.change = now.energy - first;
                                           least = std::min(least, now.plate_angle);
                                           most = std::max(most, now.plate_angle);
                                           sum.fastest = std::max(sum.fastest, std::abs(now.plate_velocity));
                                         });
  EXPECT_TRUE(status) << status.error().message;
  sum.range = most - least;
  return sum;
}

MachineProgram Program(MachineMode mode, double degrees) {
  MachineProgram program;
  program.mode = mode;
  program.speed = degrees * kDegree;
  program.highest = 15 * kDegree;
  program.lowest = -30 * kDegree;
  return program;
}

// Work of motor and muscles is stored or lost, to 1e-4 of what is exchanged.
TEST(AnkleLaboratoryTest, EnergyBalancesInRotations) {
  for (const double speed : {30.0, 120.0}) {
    const EnergyBalance sum = Balance(Program(MachineMode::kRotation, speed));
    EXPECT_LT(sum.error(), 1e-4) << speed;
    EXPECT_GT(sum.range, 0.6);
    EXPECT_NEAR(sum.fastest, speed * kDegree, 0.1 * speed * kDegree);
    EXPECT_GT(sum.lost, 0);
  }
}

TEST(AnkleLaboratoryTest, EnergyBalancesAgainstAnIsokineticMachine) {
  const EnergyBalance sum = Balance(Program(MachineMode::kIsokinetic, 60));
  EXPECT_LT(sum.error(), 1e-4);
  EXPECT_GT(sum.range, 0.4);
  // The servo holds the set speed.
  EXPECT_NEAR(sum.fastest, 60 * kDegree, 0.03 * 60 * kDegree);
  // The muscles work on the machine.
  EXPECT_GT(sum.muscles, 0);
  EXPECT_LT(sum.motor, 0);
}

TEST(AnkleLaboratoryTest, EnergyBalancesInIsometricContractions) {
  const EnergyBalance sum = Balance(Program(MachineMode::kIsometric, 60));
  EXPECT_LT(sum.error(), 1e-4);
  EXPECT_LT(sum.range, 0.02);
  EXPECT_GT(sum.muscles, 0);
}

TEST(AnkleLaboratoryTest, EnergyBalancesWithoutAFoot) {
  const AnkleSettings settings = AnkleBenchSettings();
  LaboratoryTrial trial;
  trial.program = Program(MachineMode::kRotation, 60);
  trial.foot = false;
  trial.duration = 2;
  trial.activation = [](double, std::vector<double>& activations) { activations.assign(1, 0.0); };
  const StrappedFoot<double> truth = TruePerson(settings);
  double first = NAN;
  double work = 0;
  double exchanged = 0;
  double before = 0;
  double last = 0;
  StrappedFoot<double> alone = truth;
  alone.muscles.clear();
  alone.history.clear();
  ASSERT_TRUE(SimulateLaboratory(
      settings.foot, MuscleCurves::Default(), {}, alone, trial, 1e-4, [&](const LaboratoryInstant& now) {
        const double power = now.motor_torque * now.plate_velocity - now.lost_power;
        if (std::isnan(first)) {
          first = now.energy;
        } else {
          work += 0.5e-4 * (power + before);
          exchanged += 1e-4 * std::abs(now.motor_torque * now.plate_velocity);
        }
        before = power;
        last = now.energy;
        EXPECT_EQ(now.interaction, 0);
      }));
  EXPECT_NEAR(work, last - first, 1e-4 * exchanged);
  EXPECT_GT(exchanged, 1);
}

// Laboratory less fitted model, at the laboratory's own parameters and without noise. The plate of the fitted
// model follows the recorded angle.
struct Disagreement {
  double rms = 0;
  double worst = 0;
  double ends = 0;   // worst, near the ends of the trials
  double range = 0;  // of the channel, the largest of a trial
};

// A natural spline has no acceleration at its ends; of a trial that ends while the plate turns round, the
// inertia's part of the last samples is missing.
constexpr double kEnds = 0.02;   // [s]
constexpr double kDuration = 2;  // [s]

// By task and channel.
using Disagreements = std::map<std::pair<std::string, std::string>, Disagreement>;

const std::map<std::string, double> kPerson{{"attachment_inertia", 0.07},
                                            {"attachment_gravity", 3.1},
                                            {"attachment_gravity_angle", 0.2},
                                            {"attachment_friction", 0.3},
                                            {"sole_stiffness", 7e6},
                                            {"sole_friction", 0.25},
                                            {"strap_stiffness", 8e3},
                                            {"strap_exponent", 60},
                                            {"strap_pretension", 35},
                                            {"passive_stiffness", 14},
                                            {"passive_exponent", 4.5},
                                            {"passive_linear_stiffness", 4},
                                            {"passive_damping", 0.5},
                                            {"shape", -0.9},
                                            {"filter_time", 0.03},
                                            {"delay", 0.05},
                                            {"strength.triceps", 1.1},
                                            {"strength.dorsiflexors", 0.9},
                                            {"tendon_slack_length.triceps", 1.005},
                                            {"tendon_slack_length.dorsiflexors", 0.995}};

// @param effects of both, by name
Disagreements Compare(double rate, double cutoff, int strips,
                      const std::map<std::string, std::map<std::string, double>>& effects = {}) {
  SynthesisRequest request;
  for (const auto& [name, numbers] : effects) request.effects.push_back({name, numbers});
  request.set = {{"rate", rate}, {"duration", kDuration}, {"speeds", 1}};
  request.set.insert(kPerson.begin(), kPerson.end());
  request.noise = 0;
  const auto data = SynthesizeAnkle(request);
  EXPECT_TRUE(data) << data.error().message;
  auto settings = ReadAnkleYaml(data->files.at("ankle_on_dynamometer.yaml"));
  EXPECT_TRUE(settings) << settings.error().message;
  settings->angle_cutoff = cutoff;
  settings->foot.strips = strips;
  const auto problem = BindAnkleBench(*data, *settings);
  Vector point = RestPoint(*problem);
  for (const auto& [name, value] : kPerson) point[*FindParameter(problem->parameters(), name)] = value;
  for (const auto& [name, numbers] : effects) {
    for (const auto& [parameter, value] : numbers)
      point[*FindParameter(problem->parameters(), parameter)] = value;
  }
  const auto workspace = problem->NewWorkspace();
  Prediction prediction(problem->layout());
  const std::vector<bool> all(problem->layout().size(), true);
  EXPECT_TRUE(problem->Predict({point, all, false, nullptr}, *workspace, prediction));
  Disagreements found;
  std::map<std::pair<std::string, std::string>, double> samples;
  for (std::size_t b = 0; b < problem->layout().size(); ++b) {
    const Block& block = problem->layout()[b];
    const std::pair key{data->trials.at(block.trial).task, block.channel};
    Disagreement& sum = found[key];
    for (std::size_t i = 0; i < block.measured.size(); ++i) {
      const auto at = block.sample[i];
      const double off = block.measured[i] - prediction.values(static_cast<int>(b))[at];
      const double t = block.prediction_time[static_cast<std::size_t>(at)];
      if (t < kEnds || t > kDuration - kEnds) {
        sum.ends = std::max(sum.ends, std::abs(off));
        continue;
      }
      sum.rms += off * off;
      sum.worst = std::max(sum.worst, std::abs(off));
      ++samples[key];
    }
    const auto [least, most] = std::minmax_element(block.measured.begin(), block.measured.end());
    sum.range = std::max(sum.range, *most - *least);
  }
  for (auto& [key, sum] : found) sum.rms = std::sqrt(sum.rms / samples[key]);
  return found;
}

// With the same springs under the sole, recorded at a rate that leaves nothing out, it is the same system:
// two integrators, two formulations of the boundary, of the fibres and of the machine.
TEST(AnkleLaboratoryTest, FittedModelIsTheSameSystem) {
  for (const auto& [key, off] : Compare(1000, 0, 6 * 16)) {
    if (key.second == "machine_torque") {
      EXPECT_LT(off.rms, 3e-3) << key.first;
      EXPECT_LT(off.worst, 0.15) << key.first;
    } else {
      EXPECT_LT(off.rms, 2e-7) << key.first;
      EXPECT_LT(off.worst, 2e-6) << key.first;
    }
  }
}

// What the effects of the fitted model say is what the laboratory does. Alone each changes the torque by 0.3
// to 13 N m and leaves 0.01 N m, fatigue 0.08.
TEST(AnkleLaboratoryTest, EffectsOfTheFittedModelAreThoseOfTheLaboratory) {
  using Effects = std::map<std::string, std::map<std::string, double>>;
  const Effects sides[] = {
      {{"dry_friction", {{"dry_friction", 2}}},
       {"directional_friction", {{"directional_friction", 2}}},
       {"friction_with_load", {{"friction_with_load", 0.1}}},
       {"attachment_stiffness", {{"attachment_stiffness", 5}}},
       {"axis_offset", {{"axis_offset_x", 0.01}, {"axis_offset_y", -0.01}}},
       {"strap_loosening", {{"strap_loosening", 0.002}}},
       {"sole_exponent", {{"sole_exponent", 0.3}}},
       {"boundary_relaxation", {{"boundary_relaxation_stiffness", 200}, {"boundary_relaxation_time", 0.3}}}},
      {{"passive_hysteresis", {{"passive_hysteresis", 2}}},
       {"passive_relaxation", {{"passive_relaxation_stiffness", 20}, {"passive_relaxation_time", 0.3}}},
       {"fatigue", {{"fatigue", 0.05}}},
       {"unseen_drive", {{"unseen_drive", 0.05}}},
       {"emg_crosstalk", {{"emg_crosstalk", 0.3}}},
       {"antagonist", {{"antagonist", 10}}},
       {"force_enhancement", {{"force_enhancement", 0.5}}},
       {"force_depression", {{"force_depression", 0.5}}}}};
  for (const Effects& effects : sides) {
    for (const auto& [key, off] : Compare(500, 0, 16, effects)) {
      if (key.second == "machine_torque") {
        EXPECT_LT(off.rms, 0.15) << key.first;
      }
    }
  }
}

// With its own springs and its smoothing of the angle it is off by less than a sixth of the noise of the
// laboratory's torque, 0.3 N m, and a thirtieth of that of its angle, 3 mrad. Against an isokinetic machine
// the plate's acceleration jumps, which a smooth angle does not.
TEST(AnkleLaboratoryTest, FittedModelAgrees) {
  for (const double rate : {200.0, 1000.0}) {
    for (const auto& [key, off] : Compare(rate, -1, 16)) {
      const double torque = key.first == "isokinetic contraction" ? 0.05 : 0.015;
      EXPECT_LT(off.rms, key.second == "machine_torque" ? torque : 1e-4)
          << key.first << ", " << rate << " Hz";
      EXPECT_LT(off.ends, 1.5) << key.first << ", " << rate << " Hz";
      EXPECT_GT(off.range, 0);
    }
  }
}

}  // namespace
}  // namespace sinew
