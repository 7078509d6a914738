// Whiteness of residuals and their dependence on signals, for sequences that can be worked out by hand.
#include "identify/diagnosis/discover/structure.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "base/constants.h"
#include "base/random.h"
#include "tests/identify/support/function_problem.h"

namespace sinew::diagnosis {
namespace {

// Sums of at most a few hundred numbers of order 1 to 100.
constexpr double kStructureRounding = 1e-10;

noise::NoiseBlock Residual(const std::string& channel, const std::vector<double>& values) {
  noise::NoiseBlock block;
  block.channel = channel;
  block.residual = Eigen::Map<const Vector>(values.data(), static_cast<Eigen::Index>(values.size()));
  return block;
}

// +1, -1, ... of n = 24 has the correlations (-1)^k (n - k) / n: Q = (n + 2) / n times the sum of n - k over
// 20 lags, 26 / 24 * 270. Of 24 runs 2 * 12 * 12 / 24 + 1 = 13 are expected, variance 288 * 264 / (576 * 23).
TEST(ResidualTests, AlternatingSignsMatchAHandCalculation) {
  std::vector<double> values;
  for (int i = 0; i < 24; ++i) values.push_back(i % 2 == 0 ? 1 : -1);
  const auto tests = TestResiduals({Residual("y", values)});
  ASSERT_EQ(tests.size(), 2U);
  EXPECT_EQ(tests[0].name, "Ljung-Box");
  EXPECT_EQ(tests[0].channel, "y");
  EXPECT_NEAR(tests[0].statistic, 292.5, kStructureRounding);
  EXPECT_LT(tests[0].p_value, 1e-40);
  EXPECT_EQ(tests[1].name, "runs");
  EXPECT_NEAR(tests[1].statistic, 11 / std::sqrt(288.0 * 264 / (576 * 23)), kStructureRounding);
  // Of both sides, to the digits that a script printed.
  EXPECT_NEAR(tests[1].p_value, 4.397362e-6, 1e-12);
}

// Products at the lags 1 to 7: -10, -6, 13, -2, -11, 6, -8, squares 36; a script in Python has Q = 8 * 10
// times the sum of (product / 36)^2 / (8 - lag) = 10.951793062904 and a p-value of 0.947463 (20 degrees of
// freedom).
TEST(ResidualTests, LjungBoxOfAShortSequenceMatchesAScript) {
  const auto tests = TestResiduals({Residual("y", {2, -1, 3, 0, -2, 1, 1, -4})});
  EXPECT_NEAR(tests[0].statistic, 10.951793062904, kStructureRounding);
  EXPECT_NEAR(tests[0].p_value, 0.9474630, 1e-6);
}

// Lag 1 has the products 1 and 1 of squares 4, none across the border: Q = 4 * 6 * 0.5^2 / 3 = 2.
TEST(ResidualTests, LjungBoxDoesNotCorrelateAcrossBlocks) {
  const auto tests = TestResiduals({Residual("y", {1, 1}), Residual("y", {-1, -1})});
  EXPECT_NEAR(tests[0].statistic, 2, kStructureRounding);
}

// Two runs of 3 expected with a variance of 8 * 4 / (16 * 3), and two of 2 with a variance of 0: (4 - 5) /
// sqrt(2 / 3).
TEST(ResidualTests, RunsAreCountedWithinBlocks) {
  const auto tests = TestResiduals({Residual("y", {3, 1, -1, -5}), Residual("y", {-1, 1})});
  EXPECT_NEAR(tests[1].statistic, -std::sqrt(1.5), kStructureRounding);
  // The probability of 1.224745 standard deviations, from a script.
  EXPECT_NEAR(tests[1].p_value, 0.2206714, 1e-7);
}

TEST(ResidualTests, BlocksOfOneSignHaveNoRunsToJudge) {
  const auto tests = TestResiduals({Residual("y", {1, 2, 3}), Residual("y", {-1, -1})});
  EXPECT_EQ(tests[1].statistic, 0);
  EXPECT_EQ(tests[1].p_value, 1);
}

TEST(ResidualTests, ZeroResidualIsWhite) {
  for (const ResidualTest& test : TestResiduals({Residual("y", {0, 0, 0, 0})})) {
    EXPECT_EQ(test.statistic, 0) << test.name;
    EXPECT_EQ(test.p_value, 1) << test.name;
  }
}

TEST(ResidualTests, EveryChannelIsTestedByItselfInTheOrderOfTheBlocks) {
  const auto tests = TestResiduals({Residual("z", {1, 1}), Residual("a", {0, 0}), Residual("z", {-1, -1})});
  ASSERT_EQ(tests.size(), 4U);
  EXPECT_EQ(tests[0].channel, "z");
  EXPECT_NEAR(tests[0].statistic, 2, kStructureRounding);
  EXPECT_EQ(tests[2].channel, "a");
  EXPECT_EQ(tests[2].statistic, 0);
}

// 400 cases at 5 %: 20 expected, standard deviation 4.4; four of them above or below is the limit.
TEST(ResidualTests, WhiteNoiseIsRejectedAtTheLevelOfTheTest) {
  int rejected[2] = {0, 0};
  Random random(3);
  for (int i = 0; i < 400; ++i) {
    std::vector<noise::NoiseBlock> blocks;
    for (int b = 0; b < 4; ++b) {
      std::vector<double> values;
      for (int k = 0; k < 200; ++k) values.push_back(random.Normal());
      blocks.push_back(Residual("y", values));
    }
    const auto tests = TestResiduals(blocks);
    for (std::size_t k = 0; k < 2; ++k) rejected[k] += tests[k].p_value < 0.05 ? 1 : 0;
  }
  std::printf("Ljung-Box rejects %d, runs %d of 400\n", rejected[0], rejected[1]);
  for (const int count : rejected) {
    EXPECT_LE(count, 38);
    EXPECT_GE(count, 3);
  }
}

/// Trials in which a constant 0 is predicted, so that the residual is what was measured, beside signals.
class Measured final : public FunctionProblem {
 public:
  Measured() { Add("unused", -1, 1, 0); }
  /// @param signals of its block [samples each]
  void AddTrial(const std::vector<double>& residual, std::vector<Signal> signals,
                BlockRole role = BlockRole::kTrain) {
    AddBlock("trial_" + std::to_string(signals_.size()), residual, {0}, Zero);
    roles_.push_back(role);
    signals_.push_back(std::move(signals));
    layout_ = FunctionProblem::layout();
    for (std::size_t b = 0; b < layout_.size(); ++b) layout_[b].role = roles_[b];
  }
  [[nodiscard]] const Layout& layout() const override { return layout_; }
  [[nodiscard]] std::vector<Signal> ResidualCovariates(int block) const override {
    return signals_[static_cast<std::size_t>(block)];
  }

 private:
  static Status Zero(const Vector& /*p*/, Eigen::Ref<Vector> values, Matrix* /*derivatives*/) {
    values.setZero();
    return {};
  }

  Layout layout_;
  std::vector<BlockRole> roles_;
  std::vector<std::vector<Signal>> signals_;
};

std::vector<Structure> StructureOf(const Measured& problem) {
  const auto found = FindStructure(problem, Vector::Zero(1));
  EXPECT_TRUE(found) << found.error().message;
  return found ? *found : std::vector<Structure>{};
}

constexpr int kStructureSamples = 320;
constexpr double kScatter = 1.75;  // variance of what no signal explains

int LevelOf(int i) {
  return i % 8;
}

/// The levels 0 to 7 in turn, less their mean of 3.5, times `size`, and a scatter of the same sign for all
/// eight. Variances: (64 - 1) / 12 = 5.25 and 1.75.
std::vector<double> LinearInLevel(double size = 1) {
  std::vector<double> values;
  for (int i = 0; i < kStructureSamples; ++i)
    values.push_back(size * (LevelOf(i) - 3.5) + std::sqrt(kScatter) * (i / 8 % 2 == 0 ? 1 : -1));
  return values;
}

Problem::Signal Levels() {
  Problem::Signal signal{"level", "m", {}};
  for (int i = 0; i < kStructureSamples; ++i) signal.values.push_back(LevelOf(i));
  return signal;
}

// Every knot is a level, so that the curve at it is the mean there, over 1 + 0.001 for the ridge. Left over
// of 7 are the scatter of 1.75 and 5.25 (0.001 / 1.001)^2.
constexpr double kShare = 1 - (kScatter + 5.25 / (1001.0 * 1001.0)) / 7;

TEST(Structure, ExplainedShareMatchesAHandCalculation) {
  Measured problem;
  problem.AddTrial(LinearInLevel(), {Levels()});
  problem.AddTrial(LinearInLevel(), {Levels()});
  const auto found = StructureOf(problem);
  ASSERT_EQ(found.size(), 1U) << "neither time nor the constant prediction explains anything";
  EXPECT_EQ(found[0].channel, "y");
  EXPECT_EQ(found[0].signal, "level");
  EXPECT_EQ(found[0].unit, "m");
  EXPECT_NEAR(found[0].explained_fraction, kShare, kStructureRounding);
  ASSERT_EQ(found[0].knots.size(), 8U);
  ASSERT_EQ(found[0].curve.size(), 8U);
  for (int k = 0; k < 8; ++k) {
    const auto at = static_cast<std::size_t>(k);
    EXPECT_NEAR(found[0].knots[at], k, kStructureRounding);
    EXPECT_NEAR(found[0].curve[at], (k - 3.5) / 1.001, kStructureRounding) << "measured minus predicted";
  }
  EXPECT_EQ(found[0].shape.kind, ShapeKind::kLinear);
  EXPECT_NEAR(found[0].shape.explained, 1, kStructureRounding);
}

// Both halves of one trial have every level equally often.
TEST(Structure, HalvesOfASingleTrialAreLeftOutInTurn) {
  Measured problem;
  problem.AddTrial(LinearInLevel(), {Levels()});
  const auto found = StructureOf(problem);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NEAR(found[0].explained_fraction, kShare, kStructureRounding);
}

// The curve of either trial is wrong by twice its size in the other: the share is negative.
TEST(Structure, DependenceThatAnotherTrialContradictsIsLeftOut) {
  Measured problem;
  problem.AddTrial(LinearInLevel(), {Levels()});
  problem.AddTrial(LinearInLevel(-1), {Levels()});
  EXPECT_TRUE(StructureOf(problem).empty());
}

// Low and high levels only: means -2 and 2 at the outer knots, each with half of the samples. The ridge is
// 0.001 / 4 of their diagonal: 4 (1 - (0.00025 / 1.00025)^2) of 7.
TEST(Structure, SignalsAreOrderedByWhatTheyExplain) {
  Problem::Signal half{"half", "1", {}};
  for (int i = 0; i < kStructureSamples; ++i) half.values.push_back(LevelOf(i) < 4 ? 0 : 7);
  Measured problem;
  problem.AddTrial(LinearInLevel(), {half, Levels()});
  problem.AddTrial(LinearInLevel(), {half, Levels()});
  const auto found = StructureOf(problem);
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0].signal, "level");
  EXPECT_NEAR(found[0].explained_fraction, kShare, kStructureRounding);
  EXPECT_EQ(found[1].signal, "half");
  EXPECT_NEAR(found[1].explained_fraction, 4 * (1 - std::pow(0.00025 / 1.00025, 2)) / 7, kStructureRounding);
}

// Half of the samples of every level and of either sign of the scatter.
TEST(Structure, SamplesWithoutASignalAreLeftOut) {
  Problem::Signal partly = Levels();
  std::vector<double> residual = LinearInLevel();
  for (int i = 0; i < kStructureSamples; ++i) {
    if (i / 16 % 2 == 0) continue;
    partly.values[static_cast<std::size_t>(i)] = kNaN;
    residual[static_cast<std::size_t>(i)] = 1000;
  }
  Measured problem;
  problem.AddTrial(residual, {partly});
  problem.AddTrial(residual, {partly});
  const auto found = StructureOf(problem);
  const auto level = std::find_if(found.begin(), found.end(),
                                  [](const Structure& structure) { return structure.signal == "level"; });
  ASSERT_NE(level, found.end());
  EXPECT_NEAR(level->explained_fraction, kShare, kStructureRounding);
}

TEST(Structure, HeldOutTrialsAreNotExamined) {
  Measured problem;
  problem.AddTrial(LinearInLevel(), {Levels()});
  problem.AddTrial(LinearInLevel(), {Levels()});
  problem.AddTrial(LinearInLevel(-50), {Levels()}, BlockRole::kValidate);
  const auto found = StructureOf(problem);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NEAR(found[0].explained_fraction, kShare, kStructureRounding);
}

// A line in time, -1 to 1 of every trial, has the variance 1 / 3 and is a sum of the basis functions.
TEST(Structure, ErrorThatGrowsInEveryTrialIsOneOfTime) {
  std::vector<double> residual;
  for (int i = 0; i < kStructureSamples; ++i) residual.push_back(2.0 * i / (kStructureSamples - 1) - 1);
  Measured problem;
  problem.AddTrial(residual, {});
  problem.AddTrial(residual, {});
  const auto found = StructureOf(problem);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].signal, "time");
  EXPECT_EQ(found[0].unit, "s");
  // The ridge adds 0.1 % of the mean diagonal: errors of a few times that, squared.
  EXPECT_GT(found[0].explained_fraction, 1 - 1e-4);
  EXPECT_EQ(found[0].shape.kind, ShapeKind::kLinear);
  EXPECT_EQ(found[0].knots.back(), kStructureSamples - 1);
}

// A curve of 8 values needs four samples per value, 32 in all trials together.
TEST(Structure, FewSamplesAreNotExamined) {
  for (const int samples : {15, 16}) {
    Problem::Signal line{"line", "1", {}};
    std::vector<double> residual;
    for (int i = 0; i < samples; ++i) {
      line.values.push_back(i);
      residual.push_back(i);
    }
    Measured problem;
    problem.AddTrial(residual, {line});
    problem.AddTrial(residual, {line});
    EXPECT_EQ(StructureOf(problem).empty(), samples == 15) << samples;
  }
}

// In 3000 cases of a script with numpy the share of white noise was -0.012 on average, and 0.17 % exceeded
// the 1 % that is reported: of 100 cases with the signal and time, 0.34 are expected; more than 4 once in
// 5000.
TEST(Structure, WhiteNoiseHasNone) {
  int reported = 0;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    Random random(seed);
    Measured problem;
    for (int t = 0; t < 4; ++t) {
      Problem::Signal signal{"signal", "1", {}};
      std::vector<double> residual;
      for (int i = 0; i < 250; ++i) {
        signal.values.push_back(random.Uniform());
        residual.push_back(random.Normal());
      }
      problem.AddTrial(residual, {signal});
    }
    reported += static_cast<int>(StructureOf(problem).size());
  }
  std::printf("%d reported of 200\n", reported);
  EXPECT_LE(reported, 4);
}

}  // namespace
}  // namespace sinew::diagnosis
