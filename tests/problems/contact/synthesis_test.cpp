#include "problems/contact/synthesis.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>

#include "datasets/dataset_hash.h"
#include "identify/fit_quality.h"
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

}  // namespace
}  // namespace sinew
