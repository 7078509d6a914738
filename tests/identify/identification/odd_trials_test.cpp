// A trial that contradicts the others is found, and nothing else is.
#include "identify/identification/odd_trials.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <string>

#include "identify/identification/identification.h"
#include "tests/identify/support/toy_problem.h"

namespace sinew {
namespace {

constexpr int kSamples = 60;
constexpr double kRate = 2;
using Factors = std::map<std::string, double>;

// y = rate sin(t / 5 + phase of the trial) on trials a, b, c, ...; those with a factor were recorded with it.
toy::ToyProblem Trials(int count, const Factors& factors = {}, const Factors& late = {}) {
  Layout layout;
  for (int k = 0; k < count; ++k)
    layout.push_back(toy::MakeBlock(std::string(1, static_cast<char>('a' + k)), "y", kSamples, kSamples));
  const auto shape = [](const Block& block, double t) { return std::sin(0.2 * t + block.trial[0]); };
  toy::ToyProblem problem(
      {toy::MakeParameter("rate", -10, 10, 1)}, std::move(layout),
      [=](const Block& block, double t, const Vector& p, Vector* gradient) -> Result<double> {
        if (gradient != nullptr) (*gradient)[0] = shape(block, t);
        return p[0] * shape(block, t);
      });
  problem.Measure(toy::Values({kRate}), [&](const Block& block, int i) {
    const auto of = [&](const Factors& map, double otherwise) {
      const auto found = map.find(block.trial);
      return found == map.end() ? otherwise : found->second;
    };
    const double t = block.prediction_time[static_cast<std::size_t>(i)];
    return kRate * (of(factors, 1) * shape(block, t - of(late, 0)) - shape(block, t)) +
           0.05 * std::sin(1.7 * i * i + block.trial[0]);
  });
  return problem;
}

std::vector<OddTrial> Found(const toy::ToyProblem& problem) {
  const auto fitted = Identify(problem, MakeFitSetup(problem, {}).value(), {});
  EXPECT_TRUE(fitted) << fitted.error().message;
  std::vector<OddTrial> found;
  for (const Warning& w : fitted->warnings) {
    if (w.kind == WarningKind::kOddTrial)
      found.push_back({w.names[1], w.names[0], w.names[2], w.numbers[0], w.numbers[1],
                       static_cast<int>(w.numbers[2]), w.numbers[3]});
  }
  return found;
}

TEST(OddTrialsTest, ATrialWithTheOppositeSignIsFoundWithItsErrorLeftOut) {
  const auto found = Found(Trials(4, {{"b", -1}}));
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].trial, "b");
  EXPECT_EQ(found[0].channel, "y");
  EXPECT_EQ(found[0].unit, "1");
  EXPECT_EQ(found[0].among, 4);
  // The others say 2, the trial -2: an error of 4 sin.
  EXPECT_NEAR(found[0].rmse, 4 / std::sqrt(2), 0.2);
  EXPECT_NEAR(found[0].others, 0.05 / std::sqrt(2), 0.01);
}

TEST(OddTrialsTest, TrialsThatDifferByTheirNoiseAreNotRemarked) {
  for (int count = 3; count < 8; ++count) EXPECT_TRUE(Found(Trials(count)).empty()) << count;
}

TEST(OddTrialsTest, TwoTrialsCannotTellWhichOneIsWrong) {
  EXPECT_TRUE(Found(Trials(2, {{"b", -1}})).empty());
}

TEST(OddTrialsTest, AFaultThatHarmsNothingIsNotRemarked) {
  EXPECT_TRUE(Found(Trials(4, {{"c", 1.01}})).empty());
}

// Half a second of a motion of 31 s: the error is small, and shorter trials would hide it.
TEST(OddTrialsTest, ATrialThatIsOutOfStepIsFoundWithItsDelay) {
  for (const double late : {4.0, -3.2}) {
    const auto found = Found(Trials(5, {}, {{"d", late}}));
    ASSERT_EQ(found.size(), 1U) << late;
    EXPECT_EQ(found[0].trial, "d");
    EXPECT_GT(found[0].rmse, 4 * found[0].others);
  }
}

TEST(OddTrialsTest, TwoOfSixAreFoundTheWorseOneFirst) {
  const auto found = Found(Trials(6, {{"b", -0.5}, {"e", -2}}));
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0].trial, "e");
  EXPECT_EQ(found[1].trial, "b");
}

}  // namespace
}  // namespace sinew
