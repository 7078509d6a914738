// A parameter that changes within a trial, and a curve of many knots, against trials that have them.
#include "identify/diagnosis/discover/linear_term.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include "base/random.h"
#include "identify/diagnosis/diagnosis.h"
#include "tests/identify/diagnosis/linear_laws.h"

namespace sinew::diagnosis {
namespace {

constexpr double kTermNoise = 0.1;

double SumOfSquares(const std::vector<Vector>& blocks) {
  double sum = 0;
  for (const Vector& block : blocks) sum += block.squaredNorm();
  return sum;
}

int CandidateOf(const std::vector<Candidate>& candidates, const std::string& effect) {
  for (std::size_t c = 0; c < candidates.size(); ++c) {
    if (candidates[c].effect == effect) return static_cast<int>(c);
  }
  ADD_FAILURE() << "no candidate " << effect;
  return 0;
}

/// The fitted base model of one case and its answer for one candidate, under the noise that is there.
Result<LinearTerm> Examined(const LinearLaws& problem, const std::string& effect, double correlation = 0) {
  SINEW_ASSIGN(const FitSetup setup, MakeFitSetup(problem, {}));
  const auto candidates = ListCandidates(problem, setup);
  const Refitter refitter(problem, setup, candidates);
  const Refit base = refitter.Fit({}, {setup.rest});
  if (!base.usable()) return Fail("{}", base.failure);
  noise::NoiseModel noise;
  noise.channels.emplace_back();
  noise.channels[0].deviation = kTermNoise * std::sqrt(1 - correlation * correlation);
  if (correlation > 0) noise.channels[0].coefficients = {correlation};
  for (const Block& block : problem.layout()) {
    if (block.role == BlockRole::kTrain) noise.channel_of.push_back(0);
  }
  return FitLinearTerm(problem, base, candidates[static_cast<std::size_t>(CandidateOf(candidates, effect))],
                       noise, HeldOut(problem, nullptr, 1));
}

LinearLaws::Truth Growing(double correlation) {
  LinearLaws::Truth truth;
  truth.correlation = correlation;
  truth.noise = kTermNoise;
  truth.gain_change = 0.2;
  return truth;
}

TEST(Drift, ChangeIsWithinItsInterval) {
  constexpr int kCases = 100;
  for (const double correlation : {0.0, 0.8}) {
    int within = 0;
    double squares = 0;
    int better = 0;
    for (std::uint64_t seed = 1; seed <= kCases; ++seed) {
      const auto drift =
          Examined(LinearLaws(Growing(correlation), seed, 4, 2, 80), "gain(time)", correlation);
      ASSERT_TRUE(drift) << drift.error().message;
      const double off = (drift->values[0] - 0.2) / drift->deviations[0];
      within += std::abs(off) < 1.96 ? 1 : 0;
      squares += off * off / kCases;
      better += SumOfSquares(drift->after) < SumOfSquares(drift->before) ? 1 : 0;
    }
    std::printf("correlation %g: %d of 100 within, mean square %.2f\n", correlation, within, squares);
    // 95 expected, deviation 2.2; below 88 once in a thousand.
    EXPECT_GE(within, 88) << correlation;
    // Mean of 100 squares: deviation sqrt(2 / 100), three of them. A std_error much too large fails here.
    EXPECT_NEAR(squares, 1, 0.43) << correlation;
    EXPECT_EQ(better, kCases) << correlation;
  }
}

TEST(Drift, IsZeroForAConstantParameter) {
  constexpr int kCases = 100;
  int within = 0;
  for (std::uint64_t seed = 1; seed <= kCases; ++seed) {
    const auto drift = Examined(LinearLaws({}, seed, 4, 0, 80), "gain(time)");
    ASSERT_TRUE(drift) << drift.error().message;
    within += std::abs(drift->values[0]) < 1.96 * drift->deviations[0] ? 1 : 0;
  }
  EXPECT_GE(within, 88);
}

// With a change that is known, what held-out trials keep is the noise.
TEST(Drift, LeavesTheNoiseInHeldOutTrials) {
  LinearLaws::Truth truth = Growing(0);
  truth.gain_change = 0.5;
  const LinearLaws problem(truth, 3, 4, 4);
  const auto drift = Examined(problem, "gain(time)");
  ASSERT_TRUE(drift) << drift.error().message;
  ASSERT_EQ(drift->after.size(), 4U);
  ASSERT_EQ(drift->after.front().size(), 250);
  // 1000 samples of variance 0.01: the deviation of a mean square is sqrt(2 / 1000), three of them.
  EXPECT_NEAR(SumOfSquares(drift->after) / 1000 / 0.01, 1, 0.14);
  // A change of 0.5 of a signal of variance 1.25, a third of which is the mean square of a line from -1 to 1.
  EXPECT_NEAR(SumOfSquares(drift->before) / 1000, 0.01 + 0.25 * 1.25 / 3, 0.03);
}

// The held-out trials' own values are found again after the change, and those of training trials are not
// theirs.
TEST(Drift, FitsTheHeldOutTrialsOwnValues) {
  LinearLaws::Truth truth = Growing(0);
  truth.gain_change = 0.5;
  truth.starts = true;
  const LinearLaws problem(truth, 3, 4, 4);
  const auto drift = Examined(problem, "gain(time)");
  ASSERT_TRUE(drift) << drift.error().message;
  EXPECT_NEAR(drift->values[0], 0.5, 3 * drift->deviations[0]);
  EXPECT_NEAR(SumOfSquares(drift->after) / 1000 / 0.01, 1, 0.14);
}

TEST(Drift, WithoutHeldOutTrialsThereIsNothingToCompare) {
  const auto drift = Examined(LinearLaws(Growing(0), 3, 4, 0), "gain(time)");
  ASSERT_TRUE(drift) << drift.error().message;
  EXPECT_NEAR(drift->values[0], 0.2, 3 * drift->deviations[0]);
  EXPECT_TRUE(drift->before.empty());
  EXPECT_TRUE(drift->after.empty());
}

TEST(Drift, OfAParameterThatIsNotInTheModelIsAnError) {
  // The effect is at its null: its parameter is not free, so a change of it has no derivative column.
  const auto drift = Examined(LinearLaws({}, 3), "quadratic_size(time)");
  ASSERT_FALSE(drift);
  EXPECT_NE(drift.error().message.find("quadratic_size(time)"), std::string::npos) << drift.error().message;
}

TEST(Drift, TimeRunsFromMinusOneToOneInEveryTrial) {
  Block block;
  block.prediction_time = {2, 3, 4, 5, 6};
  block.sample = {0, 2, 4};
  block.measured = {0, 0, 0};
  const Vector time = TimeInTrial(block);
  EXPECT_EQ(time, Vec3(-1, 0, 1));
  block.prediction_time = {2};
  block.sample = {0};
  block.measured = {0};
  EXPECT_EQ(TimeInTrial(block)[0], 0);
}

// A curve whose values at the knots are drawn from a normal distribution, as shrinkage assumes.
LinearLaws DrawnCurve(double deviation, std::uint64_t seed, int train, int samples) {
  LinearLaws::Truth truth;
  truth.noise = kTermNoise;
  truth.knots = 24;
  Random random(Random::StreamSeed(seed, 99));
  for (int k = 0; k < truth.knots; ++k)
    truth.effects.emplace_back("y(u)[" + std::to_string(k) + "]", deviation * random.Normal());
  return LinearLaws(truth, seed, train, 2, samples);
}

TEST(Curve, StandardDeviationsAreThoseOfTheError) {
  constexpr int kCases = 60;
  constexpr double kDeviation = 0.15;
  double squares = 0;
  double shrinkage = 0;
  int better = 0;
  for (std::uint64_t seed = 1; seed <= kCases; ++seed) {
    const LinearLaws problem = DrawnCurve(kDeviation, seed, 4, 250);
    const auto curve = Examined(problem, "y(u)");
    ASSERT_TRUE(curve) << curve.error().message;
    ASSERT_EQ(curve->values.size(), 24);
    Random random(Random::StreamSeed(seed, 99));
    for (int k = 0; k < 24; ++k)
      squares += std::pow((curve->values[k] - kDeviation * random.Normal()) / curve->deviations[k], 2) / 24;
    shrinkage += curve->shrinkage / kCases;
    better += SumOfSquares(curve->after) < SumOfSquares(curve->before) ? 1 : 0;
  }
  std::printf("mean square %.2f, deviation found %.3f, better %d of %d\n", squares / kCases, shrinkage,
              better, kCases);
  // The errors of one case are as good as 6 independent ones at least: deviation of the mean sqrt(2 / 360) =
  // 0.075. That the deviation of the values is itself an estimate (24 values: +-15 %) adds 0.1.
  EXPECT_NEAR(squares / kCases, 1.1, 0.22);
  EXPECT_NEAR(shrinkage, kDeviation, 0.03);
  EXPECT_EQ(better, kCases);
}

// One short trial covers few of the knots: without shrinkage the values at the others are very large in other
// trials.
TEST(Curve, StaysNearZeroWhereThereAreNoData) {
  constexpr int kCases = 40;
  double worst = 0;
  for (std::uint64_t seed = 1; seed <= kCases; ++seed) {
    const auto curve = Examined(DrawnCurve(0.1, seed, 1, 80), "y(u)");
    ASSERT_TRUE(curve) << curve.error().message;
    worst = std::max(worst, SumOfSquares(curve->after) / SumOfSquares(curve->before));
  }
  std::printf("held-out trials at worst %.2f of what they were\n", worst);
  EXPECT_LT(worst, 2);
}

TEST(Curve, IsZeroForDataWithoutACurve) {
  constexpr int kCases = 100;
  int flat = 0;
  for (std::uint64_t seed = 1; seed <= kCases; ++seed) {
    const auto curve = Examined(DrawnCurve(0, seed, 4, 80), "y(u)");
    ASSERT_TRUE(curve) << curve.error().message;
    flat += curve->values.cwiseAbs().maxCoeff() < 0.3 * kTermNoise ? 1 : 0;
  }
  EXPECT_GE(flat, 90);
}

TEST(Drift, DiagnosisReportsThatTheParameterIsNotConstant) {
  int named = 0;
  constexpr int kCases = 3;
  for (std::uint64_t seed = 1; seed <= kCases; ++seed) {
    const LinearLaws problem(Growing(0), seed);
    const auto setup = MakeFitSetup(problem, {});
    ASSERT_TRUE(setup);
    const auto diagnosis = Diagnose(problem, *setup, {});
    ASSERT_TRUE(diagnosis) << diagnosis.error().message;
    EXPECT_EQ(diagnosis->verdict, DiagnosisVerdict::kUnexplained) << seed;
    const auto found = std::find_if(diagnosis->unknown_terms.begin(), diagnosis->unknown_terms.end(),
                                    [](const UnknownFinding& u) { return u.kind == UnknownKind::kDrift; });
    if (found == diagnosis->unknown_terms.end()) continue;
    ++named;
    EXPECT_EQ(found->port, "gain");
    EXPECT_EQ(found->signal, "time");
    EXPECT_GT(found->curve.back(), found->curve.front()) << "it grows within a trial";
    EXPECT_GT(found->held_out_reduction, 0);
    ASSERT_EQ(found->curve.size(), 2U);
    // 1000 samples of a signal of variance 1.25: 0.005 for the change, 0.003 for the gain; four of them.
    constexpr double kWithin = 0.025;
    EXPECT_NEAR(found->curve[0], 1.8, kWithin);
    EXPECT_NEAR(found->curve[1], 2.2, kWithin);
  }
  // Forty standard errors: it is seen in every case.
  EXPECT_EQ(named, kCases);
}

}  // namespace
}  // namespace sinew::diagnosis
