#include "identify/fit_quality.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/identify/support/error_of.h"
#include "tests/identify/support/toy_problem.h"

namespace sinew {
namespace {

using toy::MakeBlock;
using toy::MakeParameter;
using toy::ToyProblem;
using toy::Values;

Block Measured(const std::string& trial, const std::string& channel, const std::vector<double>& values,
               BlockRole role = BlockRole::kTrain) {
  Block block = MakeBlock(trial, channel, static_cast<int>(values.size()), 1);
  block.measured = values;
  block.role = role;
  return block;
}

// Predicts the parameter everywhere.
ToyProblem Constant(Layout layout) {
  return ToyProblem({MakeParameter("a", -10, 10, 0)}, std::move(layout),
                    [](const Block&, double, const Vector& p, Vector*) -> Result<double> {
                      if (p[0] > 9) return Fail("too large");
                      return p[0];
                    });
}

TEST(FitQuality, RmseAndR2AreTheirFormulas) {
  const ToyProblem problem = Constant({Measured("t", "y", {1, 2, 6})});
  const auto full = PredictAll(problem, Values({4}));
  ASSERT_TRUE(full) << full.error().message;
  ASSERT_EQ(full->quality.size(), 1U);
  const FitQuality& q = full->quality[0];
  EXPECT_EQ(q.trial, "t");
  EXPECT_EQ(q.channel, "y");
  EXPECT_EQ(q.n, 3);
  EXPECT_DOUBLE_EQ(q.rmse, std::sqrt((9 + 4 + 4) / 3.0));
  EXPECT_DOUBLE_EQ(q.mae, (3 + 2 + 2) / 3.0);
  EXPECT_DOUBLE_EQ(q.r2, 1 - 17 / 14.0);
}

TEST(FitQuality, GapsAreLeftOut) {
  Block block = Measured("t", "y", {1, 2, 6});
  block.sample = {0, 2};
  block.measured = {1, 6};
  const auto full = *PredictAll(Constant({block}), Values({4}));
  EXPECT_EQ(full.quality[0].n, 2);
  EXPECT_DOUBLE_EQ(full.quality[0].rmse, std::sqrt((9 + 4) / 2.0));
  EXPECT_EQ(full.values[0], Values({4, 4, 4})) << "the prediction itself has no gap";
}

TEST(FitQuality, AChannelThatDoesNotVaryHasNoR2) {
  const auto full = *PredictAll(Constant({Measured("t", "y", {3, 3, 3})}), Values({4}));
  EXPECT_EQ(full.quality[0].rmse, 1);
  EXPECT_TRUE(std::isnan(full.quality[0].r2));
}

TEST(FitQuality, PoolsTheTrialsOfARoleByQuantity) {
  Block right = Measured("t1", "right_force_y", {0, 2});
  Block left = Measured("t2", "left_force_y", {10, 12});
  right.quantity = left.quantity = "vertical force";
  const Block unnamed = Measured("t2", "angle", {1, 2});
  const Block validate = Measured("v", "right_force_y", {1, 3}, BlockRole::kValidate);
  const auto full = *PredictAll(Constant({right, left, unnamed, validate}), Values({1}));
  ASSERT_EQ(full.quality.size(), 4U);
  ASSERT_EQ(full.pooled.size(), 3U);
  EXPECT_EQ(full.pooled[0].channel, "vertical force");
  EXPECT_EQ(full.pooled[0].n, 4);
  EXPECT_DOUBLE_EQ(full.pooled[0].rmse, std::sqrt((1 + 1 + 81 + 121) / 4.0));
  EXPECT_DOUBLE_EQ(full.pooled[0].mae, (1 + 1 + 9 + 11) / 4.0);
  // Deviations from the mean of each trial: the difference of 10 between the trials counts as explained by
  // nothing.
  EXPECT_DOUBLE_EQ(full.pooled[0].r2, 1 - 204 / 4.0);
  EXPECT_EQ(full.pooled[1].channel, "angle");
  EXPECT_EQ(full.pooled[2].role, BlockRole::kValidate);
  EXPECT_EQ(full.pooled[2].n, 2);
}

TEST(FitQuality, UnmeasuredChannelsArePredictedButNotCompared) {
  const auto full = *PredictAll(
      Constant({MakeBlock("t", "w", 3, 1, BlockRole::kPredicted), Measured("t", "y", {1, 2})}), Values({4}));
  ASSERT_EQ(full.values.size(), 2U);
  EXPECT_EQ(full.values[0], Values({4, 4, 4}));
  ASSERT_EQ(full.quality.size(), 1U);
  EXPECT_EQ(full.quality[0].channel, "y");
}

TEST(FitQuality, FailuresArePassedOn) {
  EXPECT_EQ(ErrorOf(PredictAll(Constant({Measured("t", "y", {1, 2})}), Values({9.5}))), "too large");
}

}  // namespace
}  // namespace sinew
