// Scores of candidates in cases that can be calculated by hand.
#include "identify/diagnosis/score/score.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <optional>
#include <string>

#include "identify/diagnosis/fit/refit.h"
#include "tests/identify/diagnosis/linear_laws.h"

namespace sinew::diagnosis {
namespace {

struct Scored {
  std::vector<Candidate> candidates;
  ScoreTable table;
};

Scored ScoresOf(const LinearLaws& problem) {
  const FitSetup setup = MakeFitSetup(problem, {}).value();
  Scored scored{ListCandidates(problem, setup), {}};
  const Refit base = Refitter(problem, setup, scored.candidates).Fit({}, {setup.rest});
  EXPECT_EQ(base.failure, "");
  noise::NoiseModel white;
  white.channels.emplace_back();
  white.channels[0].deviation = 0.1;
  const LeastSquares fit(problem, *base.setup);
  white.channel_of.assign(fit.train_blocks().size(), 0);
  const noise::Whitening whitening(white, TrainStretches(fit));
  const auto design = MakeDesign(fit, base.x, scored.candidates, whitening);
  EXPECT_TRUE(design) << design.error().message;
  if (design) scored.table = MakeScores(fit, *design, scored.candidates, &whitening);
  return scored;
}

/// The strongest score of the curve y(u) as a whole (nothing searched), or of a window of it.
const Score* StrongestOf(const Scored& scored, bool window) {
  const Score* best = nullptr;
  for (const Score& score : scored.table.scores) {
    if (scored.candidates[static_cast<std::size_t>(score.candidate)].effect != "y(u)") continue;
    if ((score.searched > 0) != window) continue;
    if (best == nullptr || score.p_value < best->p_value) best = &score;
  }
  return best;
}

LinearLaws::Truth Bump(int knots) {
  LinearLaws::Truth truth;
  truth.knots = knots;
  truth.effects = {{"y(u)[" + std::to_string(knots / 2 + 1) + "]", 0.12}};
  return truth;
}

// Five smooth directions of a curve have little power for a bump at one of 24 knots; windows have more,
// although each gets a fifth of the level of the whole curve.
TEST(Score, WindowsDetectLocalErrors) {
  int sharper = 0;
  constexpr int kCases = 20;
  for (std::uint64_t seed = 1; seed <= kCases; ++seed) {
    const LinearLaws problem(Bump(24), seed);
    const Scored scored = ScoresOf(problem);
    const Score* whole = StrongestOf(scored, false);
    const Score* window = StrongestOf(scored, true);
    ASSERT_TRUE(whole != nullptr && window != nullptr);
    ASSERT_GE(whole->columns.size(), 20U) << "the outermost knots are not reached";
    EXPECT_EQ(window->directions.size(), 1U);
    EXPECT_GT(window->weight, whole->weight);
    sharper += window->weight * window->p_value < whole->weight * whole->p_value ? 1 : 0;
  }
  std::printf("windows sharper in %d of %d\n", sharper, kCases);
  EXPECT_GE(sharper, 17);
}

TEST(Score, CoarseCurvesHaveNoWindows) {
  const Scored scored = ScoresOf(LinearLaws(Bump(8), 3));
  EXPECT_NE(StrongestOf(scored, false), nullptr);
  EXPECT_EQ(StrongestOf(scored, true), nullptr);
}

// What gain and rate can do too is no finding; that it changes with time is something else.
TEST(Drift, IsScoredOfAHeldParameterThatTheBaseCompensates) {
  LinearLaws::Truth truth;
  truth.scale = true;
  const LinearLaws problem(truth, 5);
  const Scored scored = ScoresOf(problem);
  const auto statistic = [&](const std::string& name) -> std::optional<double> {
    for (const Score& score : scored.table.scores) {
      if (scored.candidates[static_cast<std::size_t>(score.candidate)].effect == name) return score.statistic;
    }
    return {};
  };
  EXPECT_FALSE(statistic("scale"));
  EXPECT_TRUE(statistic("scale_size(time)"));
  EXPECT_TRUE(statistic("gain(time)"));
  EXPECT_TRUE(statistic("step"));
  EXPECT_FALSE(statistic("step_size(time)")) << "it is no part of the model";
}

}  // namespace
}  // namespace sinew::diagnosis
