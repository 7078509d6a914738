// A joint that turns over: passes the upright, near which small differences grow.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "identify/identification/identification.h"
#include "problems/drive/laboratory/synthesis.h"
#include "problems/drive/problem.h"
#include "tests/identify/support/error_of.h"

namespace sinew {
namespace {

constexpr double kNoise = 0.002;

Dataset OverTheTop(std::uint64_t seed, double duration) {
  SynthesisRequest request;
  request.seed = seed;
  request.set = {{"excitation", 2}, {"duration", duration}, {"position_noise", kNoise},
                 {"train", 2},      {"validate", 1},        {"known_noise", 0}};
  return SynthesizeDrive(request).value();
}

std::vector<double> Rmse(const Problem& problem, const Vector& parameters) {
  Prediction prediction(problem.layout());
  const std::vector<bool> all(problem.layout().size(), true);
  const auto workspace = problem.NewWorkspace();
  EXPECT_TRUE(problem.Predict({parameters, all, false, nullptr}, *workspace, prediction));
  std::vector<double> rmse;
  for (std::size_t b = 0; b < problem.layout().size(); ++b) {
    const Block& block = problem.layout()[b];
    if (block.role == BlockRole::kPredicted) continue;
    double sum = 0;
    for (std::size_t i = 0; i < block.sample.size(); ++i)
      sum += std::pow(prediction.values(static_cast<int>(b))[block.sample[i]] - block.measured[i], 2);
    rmse.push_back(std::sqrt(sum / block.samples()));
  }
  return rmse;
}

TEST(DriveTrajectories, AJointThatTurnsOverIsFittedAtItsNoise) {
  for (const std::uint64_t seed : {11, 12, 13}) {
    const auto problem = DriveProblem::Make(OverTheTop(seed, 12), {});
    ASSERT_TRUE(problem.has_value()) << ErrorOf(problem);
    const auto found = Identify(**problem, MakeFitSetup(**problem, {}).value(), {});
    ASSERT_TRUE(found.has_value()) << ErrorOf(found);
    const auto rmse = Rmse(**problem, found->parameters);
    ASSERT_EQ(rmse.size(), 3U);
    for (const double error : rmse) EXPECT_NEAR(error, kNoise, 0.1 * kNoise) << seed;
    // The laboratory's joint.
    EXPECT_NEAR(found->parameters[0], 0.04, 1e-4 * 0.04);
    EXPECT_NEAR(found->parameters[1], 0.05, 1e-3 * 0.05);
    EXPECT_NEAR(found->parameters[2], 0.6, 1e-3 * 0.6);
    EXPECT_THAT((*problem)->WarningsAt(found->parameters), testing::IsEmpty());
  }
}

TEST(DriveTrajectories, TheClosedAnswerIsTheSingleShotFromTheTruth) {
  const auto problem = DriveProblem::Make(OverTheTop(11, 12), {});
  ASSERT_TRUE(problem.has_value());
  FitRequest request;
  const auto found = Identify(**problem, MakeFitSetup(**problem, request).value(), {});
  ASSERT_TRUE(found.has_value());
  request.start = {{"inertia", 0.04}, {"viscous_friction", 0.05}, {"gravity_torque", 0.6}};
  const auto from_truth = Identify(**problem, MakeFitSetup(**problem, request).value(), {});
  ASSERT_TRUE(from_truth.has_value());
  EXPECT_NEAR(found->result.cost, from_truth->result.cost, 1e-6 * found->result.cost);
  EXPECT_NEAR(found->parameters[0], from_truth->parameters[0], 1e-6 * 0.04);
}

TEST(DriveTrajectories, GentleDataAreSingleShotsAsBefore) {
  SynthesisRequest request;
  const auto problem = DriveProblem::Make(SynthesizeDrive(request).value(), {});
  ASSERT_TRUE(problem.has_value());
  const std::vector<bool> all((*problem)->layout().size(), true);
  EXPECT_FALSE((*problem)->ImprovedStart({0, 1, 2}, all, RestPoint(**problem)).has_value());
}

TEST(DriveTrajectories, MinutesAreCutAndSaidToBe) {
  const auto problem = DriveProblem::Make(OverTheTop(4, 60), {});
  ASSERT_TRUE(problem.has_value()) << ErrorOf(problem);
  const auto found = Identify(**problem, MakeFitSetup(**problem, {}).value(), {});
  ASSERT_TRUE(found.has_value()) << ErrorOf(found);
  for (const double error : Rmse(**problem, found->parameters)) EXPECT_NEAR(error, kNoise, 0.1 * kNoise);
  RecordProperty("trajectories", static_cast<int>((*problem)->WarningsAt(found->parameters).size()));
}

}  // namespace
}  // namespace sinew
