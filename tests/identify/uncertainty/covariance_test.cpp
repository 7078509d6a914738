#include "identify/uncertainty/covariance.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/random.h"
#include "identify/uncertainty/uncertainty.h"
#include "tests/identify/support/toy_problem.h"
#include "tests/identify/uncertainty/curves.h"

namespace sinew {
namespace {

using toy::MakeBlock;
using toy::MakeParameter;
using toy::ToyFit;
using toy::ToyProblem;
using toy::Values;

std::vector<Parameter> LineParameters() {
  return {MakeParameter("offset", -100, 100, 0), MakeParameter("slope", -100, 100, 1)};
}

/// Mean reported errors and the spread that the estimates really have, over many seeds.
struct Study {
  double reported = 0;
  double robust = 0;
  double actual = 0;
};

Study Repeat(const Layout& layout, const std::function<double(Random&, const Block&, int, double)>& noise,
             int seeds) {
  Study study;
  double sum = 0;
  double squares = 0;
  for (int seed = 0; seed < seeds; ++seed) {
    ToyProblem problem(LineParameters(), layout, Line);
    Random random(static_cast<std::uint64_t>(seed) + 1);
    double last = 0;
    problem.Measure(Values({1, 4}),
                    [&](const Block& block, int i) { return last = noise(random, block, i, last); });
    const ToyFit fit(problem);
    UncertaintyOptions options;
    options.profile = false;
    const Result<Uncertainty> answer = AnalyseUncertainty(fit.view, fit.view.Start(), options);
    if (!answer) continue;
    study.reported += answer->parameters[1].std_error / seeds;
    study.robust += answer->parameters[1].std_error_robust / seeds;
    sum += answer->minimum[1];
    squares += answer->minimum[1] * answer->minimum[1];
  }
  study.actual = std::sqrt(squares / seeds - sum * sum / seeds / seeds);
  return study;
}

constexpr int kSeeds = 400;
// The actual spread has a relative error of 1 / sqrt(2 seeds) = 3.5 %: four of them.
constexpr double kSpread = 0.14;

TEST(Covariance, WhiteNoiseHasTheSamePlainAndRobustError) {
  const Study study = Repeat(
      {MakeBlock("one", "height", 150, 3)},
      [](Random& random, const Block&, int, double) { return random.Normal(); }, kSeeds);
  EXPECT_NEAR(study.reported / study.actual, 1, kSpread);
  EXPECT_NEAR(study.robust / study.actual, 1, kSpread);
}

TEST(Covariance, OnlyTheRobustErrorAllowsForCorrelatedNoise) {
  const Study study = Repeat(
      {MakeBlock("one", "height", 300, 3)},
      [](Random& random, const Block&, int i, double last) {
        return i == 0 ? random.Normal() / 0.6 : 0.8 * last + random.Normal();
      },
      kSeeds);
  EXPECT_LT(study.reported / study.actual, 0.5);  // a factor of sqrt((1 + 0.8) / (1 - 0.8)) = 3
  // What is left of the bias of a kernel estimate in 300 samples of a correlation time of ten.
  EXPECT_GT(study.robust / study.actual, 0.8);
  EXPECT_LT(study.robust / study.actual, 1.1);
}

TEST(Covariance, OnlyTheRobustErrorAllowsForGrowingNoise) {
  const Study study = Repeat(
      {MakeBlock("one", "height", 150, 3)},
      [](Random& random, const Block&, int i, double) { return std::pow(i / 75.0 - 1, 2) * random.Normal(); },
      kSeeds);
  EXPECT_LT(study.reported / study.actual, 0.8);
  EXPECT_NEAR(study.robust / study.actual, 1, kSpread);
}

TEST(Covariance, HoldsForWeightsThatAreNotOneOverTheNoise) {
  // The noisy channel counts a hundred times too much; each channel has a noise of its own, to be estimated.
  Layout layout = {MakeBlock("one", "rough", 80, 3), MakeBlock("one", "fine", 80, 3)};
  layout[0].weight = 1;
  layout[1].weight = 1;
  const Study study = Repeat(
      layout,
      [](Random& random, const Block& block, int, double) {
        return (block.channel == "rough" ? 10 : 0.1) * random.Normal();
      },
      kSeeds);
  EXPECT_NEAR(study.reported / study.actual, 1, kSpread);
}

TEST(Noise, IsEstimatedPerChannelOverItsTrials) {
  Layout layout = {MakeBlock("one", "rough", 200, 3), MakeBlock("one", "fine", 200, 3),
                   MakeBlock("two", "rough", 200, 3)};
  layout[1].weight = 7;
  ToyProblem problem(LineParameters(), layout, Line);
  Random random(5);
  problem.Measure(Values({1, 4}),
                  [&](const Block& b, int) { return (b.channel == "rough" ? 2 : 0.3) * random.Normal(); });
  const ToyFit fit(problem);
  const Result<Uncertainty> answer = AnalyseUncertainty(fit.view, fit.view.Start(), {});
  ASSERT_TRUE(answer);
  ASSERT_EQ(answer->noise.size(), 2u);
  EXPECT_EQ(answer->noise[0].channel, "rough");
  // Four standard errors of an estimated deviation: 4 / sqrt(2 n).
  EXPECT_NEAR(answer->noise[0].sigma, 2, 2 * 4 / std::sqrt(800.0));
  EXPECT_NEAR(answer->noise[1].sigma, 0.3, 0.3 * 4 / std::sqrt(400.0));
}

}  // namespace
}  // namespace sinew
