#include "problems/contact/laboratory/synthesis.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "datasets/dataset_hash.h"
#include "identify/fit_quality.h"
#include "models/multibody/osim_reader.h"
#include "problems/contact/laboratory/smooth_errors.h"
#include "tests/problems/support/stepping_data.h"

namespace sinew {
namespace {

using testing::HasSubstr;

Dataset Synthesize(std::uint64_t seed) {
  SynthesisRequest request;
  request.seed = seed;
  request.set = {{"train", 1}, {"validate", 1}};
  return SynthesizeContact(request).value();
}

std::string ErrorOf(const SynthesisRequest& request) {
  const auto data = SynthesizeContact(request);
  return data ? "" : data.error().message;
}

TEST(ContactSynthesis, ASeedNamesOneDataSet) {
  EXPECT_EQ(DatasetHash(Synthesize(5)), DatasetHash(Synthesize(5)));
  EXPECT_NE(DatasetHash(Synthesize(5)), DatasetHash(Synthesize(6)));
}

TEST(ContactSynthesis, IsMarkedSynthetic) {
  const Dataset data = Synthesize(1);
  EXPECT_TRUE(data.synthetic);
  EXPECT_TRUE(data.Check());
  EXPECT_EQ(data.trials.at("train_1").role, Role::kTrain);
  EXPECT_EQ(data.trials.at("validate_1").role, Role::kValidate);
}

// Every number of the data.
void ForEachNumber(const Dataset& data, const std::function<void(double)>& visit) {
  for (const auto& [name, constant] : data.constants) visit(constant.value);
  for (const auto& [name, trial] : data.trials) {
    for (const auto& [condition, value] : trial.conditions) visit(value);
    for (const auto& [grid_name, grid] : trial.grids) {
      for (const auto& [channel_name, channel] : grid.channels) {
        if (channel.sigma) visit(*channel.sigma);
        for (const double value : channel.values) visit(value);
      }
    }
  }
}

TEST(ContactSynthesis, TheTruthIsNotInTheData) {
  // Numbers that occur nowhere by accident.
  const std::map<std::string, double> truth{{"stiffness", 871234.5},
                                            {"dissipation", 43.2187},
                                            {"static_friction", 0.917263},
                                            {"dynamic_friction", 0.583741},
                                            {"viscous_friction", 0.518273}};
  const Dataset data = SteppingData(truth);
  for (const auto& [name, value] : truth) {
    const double hidden = value;
    ForEachNumber(data, [&](double number) { EXPECT_NE(number, hidden); });
    const std::string digits = fmt::format("{}", value);
    for (const auto& [file, text] : data.files) EXPECT_EQ(text.find(digits), std::string::npos) << file;
    for (const std::string& text : {data.title, data.subject, data.source, data.licence}) {
      EXPECT_EQ(text.find(digits), std::string::npos) << text;
    }
  }
}

// A search that starts at the truth has found nothing.
TEST(ContactSynthesis, NoDefaultTruthIsAStart) {
  const Dataset data = Synthesize(1);
  const auto settings = ParseContactSettings(data, SettingsText(data)).value();
  for (const auto& [setting, description] : ContactExperiment()) {
    const auto range = settings.parameters.find(setting);
    if (range == settings.parameters.end()) continue;
    const auto at = description.find("(default ");
    ASSERT_NE(at, std::string::npos) << description;
    EXPECT_NE(ParseNumber(description.substr(at + 9, description.find(')', at) - at - 9)),
              range->second.start)
        << setting;
  }
}

// No inverse crime, but the crime's absence must not show: with the true parameters, the fitted model
// (coarser mesh, motion known 60 times a second) predicts the simulated truth to a tenth of the noise.
TEST(ContactSynthesis, TheFittedModelDiffersFromTheTruthByLessThanATenthOfTheNoise) {
  constexpr double kNoise = 0.9;  // default of force_noise [N]
  double worst = 0;
  double squares = 0;
  int samples = 0;
  for (const int seed : {1, 2, 3}) {
    SynthesisRequest request;
    request.seed = static_cast<std::uint64_t>(seed);
    request.set = kTruth;
    request.set["encoders"] = 1;
    request.noise = 0;
    const Dataset data = SynthesizeContact(request).value();
    const auto problem = MakeContact(data, SettingsText(data)).value();
    const FullPrediction prediction = PredictAll(*problem, TruthOf(*problem)).value();
    for (const FitQuality& quality : prediction.quality) {
      if (quality.channel.find("force_y") == std::string::npos) continue;
      worst = std::max(worst, quality.rmse);
      squares += quality.n * quality.rmse * quality.rmse;
      samples += quality.n;
    }
  }
  std::printf("RMSE of the vertical force: %.4f N over all stances, %.4f N in the worst\n",
              std::sqrt(squares / samples), worst);
  EXPECT_LT(worst, 0.1 * kNoise);
}

Dataset StepsOfAPerson(const std::map<std::string, double>& settings, std::optional<double> noise = {}) {
  SynthesisRequest request;
  request.seed = 3;
  request.set = {{"person", 1}, {"encoders", 1}};
  for (const auto& [name, value] : settings) request.set[name] = value;
  request.noise = noise;
  return SynthesizeContact(request).value();
}

TEST(ContactSynthesis, APersonCarries70KilogramsOnSolesOf26Centimetres) {
  const Dataset data = StepsOfAPerson({{"train", 2}, {"validate", 0}, {"fine", 0}});
  EXPECT_TRUE(data.synthetic);
  EXPECT_NEAR(data.constants.at("body_mass").value, 70, 1e-6);
  for (const auto& [name, trial] : data.trials) {
    const auto& channels = trial.grids.at("forces").channels;
    const std::string plate = channels.count("right_force_y") > 0 ? "right" : "left";
    const auto& force = channels.at(plate + "_force_y").values;
    const double most = *std::max_element(force.begin(), force.end());
    EXPECT_GT(most, 0.7 * 70 * 9.81);
    EXPECT_LT(most, 1.5 * 70 * 9.81);
    double heel = 1;
    double toe = -1;
    for (const double x : channels.at(plate + "_cop_x").values) {
      if (!std::isfinite(x)) continue;
      heel = std::min(heel, x);
      toe = std::max(toe, x);
    }
    EXPECT_GT(toe - heel, 0.1) << "the foot rolls";
    EXPECT_LT(toe - heel, 0.3);
  }
}

// With the true parameters and motion the fitted model (coarser mesh, motion known 60 times a second)
// predicts all six channels of a plate to a third of the noise.
TEST(ContactSynthesis, OfAPersonTheFittedModelDiffersFromTheTruthByLittle) {
  const Dataset noisy = StepsOfAPerson({});
  const std::map<std::string, double> truth{{"stiffness", 1.9e6},
                                            {"dissipation", 2.5},
                                            {"static_friction", 0.9},
                                            {"dynamic_friction", 0.6},
                                            {"viscous_friction", 0.5}};
  const Dataset data = StepsOfAPerson({}, 0.0);
  const auto problem =
      MakeContact(data, SettingsText(data, "objective: likelihood", "objective: normalised")).value();
  Vector parameters = RestPoint(*problem);
  for (const auto& [name, value] : truth)
    parameters[FindParameter(problem->parameters(), name).value()] = value;
  const Prediction prediction = PredictEverything(*problem, parameters);
  std::map<std::string, std::pair<double, double>> squares;  // of errors over noise, and their number
  for (std::size_t b = 0; b < problem->layout().size(); ++b) {
    const Block& block = problem->layout()[b];
    const double noise = *noisy.trials.at(block.trial).Find(block.channel).channel->sigma;
    auto& [sum, count] = squares[block.channel.substr(block.channel.find('_') + 1)];
    for (std::size_t i = 0; i < block.measured.size(); ++i) {
      const double error = prediction.values(static_cast<int>(b))[block.sample[i]] - block.measured[i];
      sum += error * error / (noise * noise);
      count += 1;
    }
  }
  ASSERT_EQ(squares.size(), 6U);
  for (const auto& [kind, sum] : squares) {
    const double ratio = std::sqrt(sum.first / sum.second);
    std::printf("%-10s error of the fitted model %.3f of the noise\n", kind.c_str(), ratio);
    EXPECT_LT(ratio, 1.0 / 3) << kind;
  }
}

// Where the recorded coordinates have the middle of the stance foot's sole, and its rotation.
std::vector<BodyMotion> SoleMiddles(const Dataset& data, const Trial& trial) {
  const auto model =
      MultibodyModel::Build(ReadOsim(data.files.at("model.osim"), "model.osim").value()).value();
  const bool right = trial.task == "right stance";
  const int body = model.BodyIndex(right ? "calcn_r" : "calcn_l").value();
  const Grid& recorded = trial.grids.at("coordinates");
  const auto motions = model.BodyMotions(recorded.time, RecordedMotion(model, recorded), {body}).value();
  std::vector<BodyMotion> feet;
  for (const auto& bodies : motions) {
    feet.push_back(bodies.front());
    feet.back().position += feet.back().rotation * Vec3(0.0325, -0.07343375, 0);
  }
  return feet;
}

TEST(ContactSynthesis, ErrorsOfTheMotionMoveTheRecordedFootAndNotTheForce) {
  const std::map<std::string, double> size{{"train", 20}, {"validate", 0}, {"fine", 0}};
  auto with_errors = size;
  with_errors["motion_error"] = 0.005;
  with_errors["rotation_error"] = 0.0262;
  const Dataset exact = StepsOfAPerson(size);
  const Dataset data = StepsOfAPerson(with_errors);
  Vec3 shifts = Vec3::Zero();
  Vec3 turns = Vec3::Zero();
  int samples = 0;
  for (const auto& [name, trial] : data.trials) {
    const Trial& true_trial = exact.trials.at(name);
    const auto& forces = trial.grids.at("forces").channels;
    for (const auto& [channel, measured] : forces) {
      const auto& same = true_trial.grids.at("forces").channels.at(channel).values;
      ASSERT_EQ(measured.values.size(), same.size());
      for (std::size_t i = 0; i < same.size(); ++i)
        EXPECT_TRUE(measured.values[i] == same[i] || std::isnan(same[i])) << channel;
    }
    EXPECT_EQ(trial.grids.at("coordinates").channels.at("pelvis_ty").values,
              true_trial.grids.at("coordinates").channels.at("pelvis_ty").values);
    const auto recorded = SoleMiddles(data, trial);
    const auto truth = SoleMiddles(exact, true_trial);
    for (std::size_t i = 0; i < truth.size(); ++i) {
      const Mat3 turned = recorded[i].rotation * truth[i].rotation.transpose();
      const Vec3 turn = 0.5 * Vec3(turned(2, 1) - turned(1, 2), turned(0, 2) - turned(2, 0),
                                   turned(1, 0) - turned(0, 1));  // small angles
      shifts += (recorded[i].position - truth[i].position).cwiseAbs2();
      turns += turn.cwiseAbs2();
      ++samples;
    }
  }
  // 20 stances of 0.93 s are about 20 x 3 independent values: their standard deviation is known to 9 %.
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(std::sqrt(shifts[axis] / samples), 0.005, 3 * 0.09 * 0.005);
    EXPECT_NEAR(std::sqrt(turns[axis] / samples), 0.0262, 3 * 0.09 * 0.0262);
  }
}

TEST(ContactSynthesis, SmoothErrorsHaveTheStatedSizeAndCorrelation) {
  constexpr int kDraws = 4000;
  Random random(5);
  double variance = 0;
  double product = 0;
  double turn = 0;
  for (int i = 0; i < kDraws; ++i) {
    const SmoothErrors errors(0.005, 0.02, 0.2, random);
    const FootError now = errors.At(0.1);
    variance += now.shift.y() * now.shift.y() / kDraws;
    product += now.shift.y() * errors.At(0.3).shift.y() / kDraws;
    turn += now.turn.x() * now.turn.x() / kDraws;
  }
  const double rounding = 4 * std::sqrt(2.0 / kDraws);
  EXPECT_NEAR(variance / (0.005 * 0.005), 1, rounding);
  EXPECT_NEAR(turn / (0.02 * 0.02), 1, rounding);
  EXPECT_NEAR(product / variance, std::exp(-0.5), rounding);
}

TEST(ContactSynthesis, ADistortionChangesTheVerticalForceAndNothingElse) {
  constexpr double kRounding = 1e-13;
  SynthesisRequest request;
  request.set = {{"train", 1}, {"validate", 0}};
  const Dataset plain = SynthesizeContact(request).value();
  request.effects = {{"force_y.offset", {{"value", 5}}}, {"force_y.drift", {{"value", 2}}}};
  const Dataset distorted = SynthesizeContact(request).value();
  const Grid& before = plain.trials.at("train_1").grids.at("forces");
  const Grid& after = distorted.trials.at("train_1").grids.at("forces");
  EXPECT_EQ(before.channels.at("right_force_x").values, after.channels.at("right_force_x").values);
  const auto& y = before.channels.at("right_force_y").values;
  const auto& y_distorted = after.channels.at("right_force_y").values;
  const double slope = (y_distorted.back() - y.back() - y_distorted.front() + y.front()) /
                       (before.time.back() - before.time.front());
  EXPECT_NEAR(slope, 2, 100 * kRounding);
  double mean = 0;
  for (std::size_t i = 0; i < y.size(); ++i) mean += (y_distorted[i] - y[i]) / static_cast<double>(y.size());
  EXPECT_NEAR(mean, 5, 2.0 / 60) << "the drift is about the middle of the trial, to half a sample";
}

TEST(ContactSynthesis, APlateOfItsOwnIsDistortedAlone) {
  SynthesisRequest request;
  request.set = {{"train", 2}, {"validate", 0}};
  const Dataset plain = SynthesizeContact(request).value();
  request.effects = {{"right_force_y.gain", {{"right_force_y.gain", 1.5}}}};
  const Dataset distorted = SynthesizeContact(request).value();
  const auto channel = [](const Dataset& data, const char* trial, const char* name) {
    return data.trials.at(trial).grids.at("forces").channels.at(name).values;
  };
  EXPECT_NE(channel(plain, "train_1", "right_force_y"), channel(distorted, "train_1", "right_force_y"));
  EXPECT_EQ(channel(plain, "train_1", "right_force_x"), channel(distorted, "train_1", "right_force_x"));
  EXPECT_EQ(channel(plain, "train_2", "left_force_y"), channel(distorted, "train_2", "left_force_y"));
}

// The effects that are hidden are those that the problem knows: with the true values it predicts the truth as
// well as without any effect.
TEST(ContactSynthesis, WithTheHiddenEffectTheFittedModelIsTheTruth) {
  constexpr double kNoise = 0.9;  // default of force_noise [N]
  const std::vector<std::pair<std::string, std::map<std::string, double>>> hidden{
      {"height_offset", {{"height_offset", 8e-4}}},
      {"left.height_offset", {{"left.height_offset", -5e-4}}},
      {"floor_compliance", {{"floor_compliance", 4e-7}}},
      {"stiffness_exponent", {{"stiffness_exponent", 0.3}}},
      {"tilted_floor", {{"floor_slope_x", 0.01}, {"floor_slope_z", -0.008}}},
      {"unmodelled_mass", {{"unmodelled_mass", 0.5}}},
      {"missing_toe_region", {{"toe_region_weight", 0.7}}},
      {"missing_heel_region", {{"heel_region_weight", 0.7}}},
      {"linear_damping", {{"linear_damping", 2e4}}},
      {"uneven_stiffness",
       {{"stiffness_toes_to_heel", 0.4},
        {"stiffness_middle_to_ends", -0.3},
        {"stiffness_outside_to_inside", 0.5}}},
      {"foot_bend", {{"foot_bend_early", -0.01}, {"foot_bend_middle", 0.02}, {"foot_bend_late", 0.03}}},
      {"foot_pitch", {{"foot_pitch_early", -0.008}, {"foot_pitch_middle", 0.02}, {"foot_pitch_late", 0.01}}},
      {"foot_height",
       {{"foot_height_early", 1e-4}, {"foot_height_middle", -1.5e-4}, {"foot_height_late", 1e-4}}},
  };
  for (const auto& effect : hidden) {
    SynthesisRequest request;
    request.set = kTruth;
    request.set["encoders"] = 1;
    request.noise = 0;
    request.set["train"] = 2;
    request.set["validate"] = 0;
    request.effects = {effect};
    const Dataset data = SynthesizeContact(request).value();
    const auto problem = MakeContact(data, SettingsText(data)).value();
    const auto rmse = [&](const Vector& parameters) {
      // A mass counts once the foot is down: of a light foot both models need not agree on that.
      constexpr double kFootIsDown = 10;  // [N]
      double squares = 0;
      int samples = 0;
      const Prediction prediction = PredictEverything(*problem, parameters);
      for (const Stance& stance : problem->data().stances) {
        const Block& block = problem->layout()[static_cast<std::size_t>(stance.blocks[1])];
        for (std::size_t i = 0; i < block.measured.size(); ++i) {
          if (block.measured[i] < kFootIsDown) continue;
          const double error = prediction.values(stance.blocks[1])[block.sample[i]] - block.measured[i];
          squares += error * error;
          ++samples;
        }
      }
      EXPECT_GT(samples, 40);
      return std::sqrt(squares / samples);
    };
    Vector truth = TruthOf(*problem);
    const double without = rmse(truth);
    for (const auto& [name, value] : effect.second)
      truth[FindParameter(problem->parameters(), name).value()] = value;
    if (effect.first == "tilted_floor") {
      // The laboratory's floor turns about another point: there it is higher by a constant.
      constexpr std::array<double, 2> kPivot{0.02, 0};  // of contact_synthesis.cpp
      const auto& reference = problem->data().stances.front().kinematics.tilt_reference;
      truth[FindParameter(problem->parameters(), "height_offset").value()] =
          effect.second.at("floor_slope_x") * (reference[0] - kPivot[0]) +
          effect.second.at("floor_slope_z") * (reference[1] - kPivot[1]);
    }
    const double with = rmse(truth);
    std::printf("%-20s %.2f N without it, %.3f N with it\n", effect.first.c_str(), without, with);
    EXPECT_GT(without, kNoise) << effect.first;
    EXPECT_LT(with, 0.1 * kNoise) << effect.first;
  }
}

// The laboratory computes the memory of the sole at every sample of a plate, the problem at the frames.
TEST(ContactSynthesis, ASoleThatGivesWayIsThatOfTheFittedModel) {
  SynthesisRequest request;
  request.set = kTruth;
  request.set["static_friction"] = request.set["dynamic_friction"] = 0.6;
  request.set["encoders"] = 1;
  request.noise = 0;
  request.set["train"] = 2;
  request.set["validate"] = 0;
  request.effects = {{"shear_compliance", {{"shear_compliance", 5e-5}}}};
  const Dataset data = SynthesizeContact(request).value();
  const auto problem = MakeContact(data, SettingsText(data)).value();
  const auto rmse = [&](double compliance) {
    Vector parameters = TruthOf(*problem);
    for (const char* name : {"static_friction", "dynamic_friction"})
      parameters[FindParameter(problem->parameters(), name).value()] = 0.6;
    parameters[FindParameter(problem->parameters(), "shear_compliance").value()] = compliance;
    double squares = 0;
    double samples = 0;
    const Prediction prediction = PredictEverything(*problem, parameters);
    for (const Stance& stance : problem->data().stances) {
      const Block& block = problem->layout()[static_cast<std::size_t>(stance.blocks[kFx])];
      for (std::size_t i = 0; i < block.measured.size(); ++i) {
        const double error = prediction.values(stance.blocks[kFx])[block.sample[i]] - block.measured[i];
        squares += error * error;
        samples += 1;
      }
    }
    return std::sqrt(squares / samples);
  };
  const double without = rmse(0);
  const double with = rmse(5e-5);
  std::printf("forward force: %.2f N without it, %.2f N with it\n", without, with);
  EXPECT_GT(without, 1);
  EXPECT_LT(with, 0.25 * without);
}

TEST(ContactSynthesis, WhatItDoesNotKnowIsAnError) {
  SynthesisRequest request;
  request.set = {{"stifness", 1e6}};
  EXPECT_EQ(ErrorOf(request), "--set: 'stifness' does not exist; did you mean 'stiffness'?");
  request.set = {{"stiffness", -1}};
  EXPECT_THAT(ErrorOf(request), HasSubstr("--set stiffness=-1: expected 10000 to "));
  request.set = {{"stiffness", std::nan("")}};
  EXPECT_THAT(ErrorOf(request), HasSubstr("--set stiffness=nan: expected "));
  request = {};
  request.effects = {{"force_y.ofset", {{"value", 1}}}};
  EXPECT_EQ(ErrorOf(request), "--effect: 'force_y.ofset' does not exist; did you mean 'force_y.offset'?");
  request.effects = {{"force_y.offset", {{"size", 1}}}};
  EXPECT_THAT(ErrorOf(request), HasSubstr("--effect force_y.offset: 'size' does not exist"));
  request.effects = {{"tilted_floor", {{"value", 0.01}}}};
  EXPECT_THAT(ErrorOf(request), HasSubstr("--effect tilted_floor: 'value' does not exist; expected one of"));
  request.effects = {{"height_offset", {}}};
  EXPECT_EQ(ErrorOf(request), "--effect height_offset: expected height_offset:height_offset=NUMBER");
  request.effects = {{"height_offset", {{"value", 1}}}};
  EXPECT_EQ(ErrorOf(request), "--effect height_offset:value=1: expected -0.0100 to 0.0100 m");
  request = {};
  request.noise = -1;
  EXPECT_EQ(ErrorOf(request), "--noise -1: expected a factor of at least 0");
}

TEST(ContactSynthesis, AWholeRecordHoldsTheSamplesOfTheExportedOne) {
  const Dataset few = SteppingData({{"train", 1}, {"validate", 0}}, 0);
  const Dataset all = SteppingData({{"train", 1}, {"validate", 0}, {"full_rate", 1}}, 0);
  const Grid& exported = few.trials.at("train_1").grids.at("forces");
  const Grid& whole = all.trials.at("train_1").grids.at("forces");
  ASSERT_GT(whole.time.size(), 15 * exported.time.size());
  for (const auto& [name, channel] : exported.channels) {
    for (std::size_t i = 0; i < exported.time.size(); ++i) {
      EXPECT_EQ(whole.time[16 * i], exported.time[i]);
      EXPECT_EQ(whole.channels.at(name).values[16 * i], channel.values[i]) << name;
    }
  }
}

}  // namespace
}  // namespace sinew
