// Readings that are multiples of a step.
#include "identify/diagnosis/score/quantised_channels.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "identify/diagnosis/diagnosis.h"
#include "tests/identify/diagnosis/linear_laws.h"

namespace sinew::diagnosis {
namespace {

constexpr double kChannelNoise = 0.1;

LinearLaws::Truth Rounded(double step) {
  LinearLaws::Truth truth;
  truth.noise = kChannelNoise;
  truth.reading_step = step;
  return truth;
}

/// All parameters where they are true.
Vector TruePoint(const LinearLaws& problem) {
  Vector point(static_cast<Eigen::Index>(problem.parameters().size()));
  for (std::size_t i = 0; i < problem.parameters().size(); ++i)
    point[static_cast<Eigen::Index>(i)] = problem.parameters()[i].rest_value();
  point[problem.Index("gain")] = 2;
  point[problem.Index("rate")] = 0.3;
  return point;
}

double TrainingSquares(const LinearLaws& problem, const Vector& point) {
  const std::vector<bool> wanted(problem.layout().size(), true);
  Prediction prediction(problem.layout());
  const auto workspace = problem.NewWorkspace();
  EXPECT_TRUE(problem.Predict({point, wanted}, *workspace, prediction));
  double squares = 0;
  for (std::size_t b = 0; b < problem.layout().size(); ++b) {
    const Block& block = problem.layout()[b];
    if (block.role != BlockRole::kTrain) continue;
    for (std::size_t i = 0; i < block.measured.size(); ++i)
      squares += std::pow(prediction.values(static_cast<int>(b))[block.sample[i]] - block.measured[i], 2);
  }
  return squares;
}

Diagnosis Examine(const LinearLaws& problem) {
  const auto setup = MakeFitSetup(problem, {});
  EXPECT_TRUE(setup);
  auto diagnosis = Diagnose(problem, *setup, {});
  EXPECT_TRUE(diagnosis) << diagnosis.error().message;
  return diagnosis ? *diagnosis : Diagnosis{};
}

TEST(Quantisation, NamesTheEffectTheStepAndItsShare) {
  const LinearLaws problem(Rounded(0.3), 3);
  const Vector point = TruePoint(problem);
  const auto found = FindQuantisation(problem, point);
  ASSERT_TRUE(found) << found.error().message;
  ASSERT_EQ(found->size(), 1U);
  const Quantisation& rounding = found->front();
  EXPECT_EQ(rounding.channel, "y");
  EXPECT_EQ(rounding.effect, "y.quantisation");
  EXPECT_EQ(rounding.unit, "1");
  EXPECT_NEAR(rounding.step, 0.3, 1e-12);  // multiples of a double
  EXPECT_GT(rounding.uncertainty, 0);
  EXPECT_LE(rounding.uncertainty, 0.02 * 0.3);
  // Four trials of 250 samples; held-out ones do not count.
  const double variance = TrainingSquares(problem, point) / 1000;
  EXPECT_NEAR(rounding.statistic, 1000 * (0.3 * 0.3 / 12) / variance, 1e-9 * rounding.statistic);
  // The residual's variance is that of the noise and of rounding; a mean square of 1000 has the deviation
  // 4.5 %.
  EXPECT_NEAR(variance / (kChannelNoise * kChannelNoise + 0.3 * 0.3 / 12), 1, 0.14);
}

TEST(Quantisation, ContinuousReadingsHaveNone) {
  const LinearLaws problem(Rounded(0), 3);
  const auto found = FindQuantisation(problem, TruePoint(problem));
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_TRUE(found->empty());
}

TEST(Quantisation, IsNotNamedWhereTheProblemHasNoSuchEffect) {
  LinearLaws::Truth truth;
  const LinearLaws continuous(truth, 3);
  EXPECT_EQ(continuous.Index("y.quantisation_size"), -1);
  const auto found = FindQuantisation(continuous, TruePoint(continuous));
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_TRUE(found->empty());
}

TEST(Quantisation, IsTheOnlyEffectRemovedFromTheCandidates) {
  const LinearLaws problem(Rounded(0.3), 3);
  const auto setup = MakeFitSetup(problem, {});
  ASSERT_TRUE(setup);
  auto candidates = ListCandidates(problem, *setup);
  const auto is = [](const Candidate& c) { return c.effect == "y.quantisation"; };
  ASSERT_EQ(std::count_if(candidates.begin(), candidates.end(), is), 1);
  const std::size_t before = candidates.size();
  RemoveQuantisation(problem, candidates);
  EXPECT_EQ(std::count_if(candidates.begin(), candidates.end(), is), 0);
  EXPECT_EQ(candidates.size() + 1, before);
}

TEST(Quantisation, DiagnosisStatesItAsACause) {
  const Diagnosis d = Examine(LinearLaws(Rounded(0.3), 3));
  EXPECT_EQ(d.verdict, DiagnosisVerdict::kExplained);
  ASSERT_EQ(d.causes.size(), 1U);
  EXPECT_EQ(d.causes[0].effect, "y.quantisation");
  ASSERT_EQ(d.causes[0].parameters.size(), 1U);
  EXPECT_LE(d.causes[0].parameters[0].ci95[0], 0.3);
  EXPECT_GE(d.causes[0].parameters[0].ci95[1], 0.3);
  EXPECT_EQ(d.family_p_value, 0) << "certain";
}

TEST(Quantisation, FarBelowTheNoiseIsNoCause) {
  const Diagnosis d = Examine(LinearLaws(Rounded(0.005), 3));
  EXPECT_EQ(d.verdict, DiagnosisVerdict::kAdequate);
  EXPECT_TRUE(d.causes.empty());
  const auto score = std::find_if(d.scores.begin(), d.scores.end(),
                                  [](const EffectScore& s) { return s.effect == "y.quantisation"; });
  ASSERT_NE(score, d.scores.end()) << "it is there all the same";
  // 1000 * 0.005^2 / 12 / 0.1^2, with the residual's variance to 14 % as above.
  EXPECT_NEAR(score->statistic, 0.208, 0.03);
  EXPECT_EQ(score->p_value, 1);
}

TEST(Quantisation, IsFoundBesideAnotherCause) {
  LinearLaws::Truth truth = Rounded(0.2);
  truth.effects = {{"quadratic_size", 0.1}};
  const Diagnosis d = Examine(LinearLaws(truth, 7));
  ASSERT_EQ(d.causes.size(), 2U);
  const auto has = [&](const std::string& effect) {
    return std::any_of(d.causes.begin(), d.causes.end(), [&](const Cause& c) { return c.effect == effect; });
  };
  EXPECT_TRUE(has("quadratic"));
  EXPECT_TRUE(has("y.quantisation"));
}

}  // namespace
}  // namespace sinew::diagnosis
