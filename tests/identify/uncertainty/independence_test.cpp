// The tests of independent errors: how often they reject white noise, and that they see what they should.
#include "identify/uncertainty/independence.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "base/random.h"
#include "tests/identify/support/toy_problem.h"
#include "tests/identify/uncertainty/curves.h"

namespace sinew {
namespace {

using toy::MakeBlock;
using toy::MakeParameter;
using toy::ToyFit;
using toy::ToyProblem;
using toy::Values;

constexpr int kRepeats = 400;

// Share of repetitions in which the residuals of the true line look independent.
double ShareIndependent(int samples, const std::function<double(Random&, int, double)>& next) {
  double share = 0;
  for (int seed = 0; seed < kRepeats; ++seed) {
    ToyProblem problem({MakeParameter("a", -50, 50, 1), MakeParameter("b", -50, 50, 4)},
                       {MakeBlock("one", "height", samples, 2), MakeBlock("two", "height", samples, 2)},
                       Line);
    Random random(Random::StreamSeed(99, static_cast<std::uint64_t>(seed)));
    double last = 0;
    problem.Measure(Values({1, 4}), [&](const Block&, int i) { return last = next(random, i, last); });
    const ToyFit fit(problem);
    const auto at = uncertainty::Linearize(fit.view, fit.view.Start());
    EXPECT_TRUE(at);
    if (at && uncertainty::ResidualsLookIndependent(fit.view, *at)) share += 1.0 / kRepeats;
  }
  return share;
}

TEST(Independence, WhiteNoiseIsRejectedInFivePercent) {
  const double share = ShareIndependent(60, [](Random& random, int, double) { return random.Normal(); });
  // Bonferroni is conservative, and a share of 400 has a standard deviation of 1 %.
  EXPECT_GT(share, 0.95 - 0.04);
}

TEST(Independence, CorrelatedNoiseIsRejected) {
  const double share =
      ShareIndependent(60, [](Random& random, int, double last) { return 0.5 * last + random.Normal(); });
  EXPECT_LT(share, 0.02);
}

TEST(Independence, LevelThatGrowsIsRejected) {
  const double share = ShareIndependent(
      200, [](Random& random, int i, double) { return (1 + 4.0 * i / 200) * random.Normal(); });
  EXPECT_LT(share, 0.02);
}

TEST(Independence, FewSamplesTellNothing) {
  EXPECT_EQ(ShareIndependent(10, [](Random& random, int, double) { return random.Normal(); }), 0);
}

}  // namespace
}  // namespace sinew
