// Random starts of refits.
#include "identify/diagnosis/select/many_starts.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/identify/diagnosis/linear_laws.h"

namespace sinew::diagnosis {
namespace {

FitSetup SetupWith(const LinearLaws& problem, const char* effect) {
  FitRequest request;
  request.release = {effect};
  return *MakeFitSetup(problem, request);
}

TEST(ManyStarts, DrawsStayInTheirRangesAndMoveFreeParametersOnly) {
  const LinearLaws problem({}, 1, 4, 0, 50);
  const FitSetup setup = SetupWith(problem, "drift");
  Random random(3);
  for (int turn = 0; turn < 200; ++turn) {
    const Vector drawn = DrawStart(setup, setup.rest, turn, random);
    for (std::size_t i = 0; i < setup.parameters.size(); ++i) {
      const Parameter& p = setup.parameters[i];
      const auto index = static_cast<Eigen::Index>(i);
      EXPECT_GE(drawn[index], p.lower);
      EXPECT_LE(drawn[index], p.upper);
      const bool moves = setup.IsFree(static_cast<int>(i)) && p.kind != ParameterKind::kNuisance;
      if (!moves) {
        EXPECT_EQ(drawn[index], setup.rest[index]) << p.name;
      }
    }
  }
}

TEST(ManyStarts, EffectsAreDrawnOverTwoDecadesOfTheirRange) {
  const LinearLaws problem({}, 1, 4, 0, 50);
  const FitSetup setup = SetupWith(problem, "drift");
  Random random(3);
  int near = 0;
  int far = 0;
  for (int draw = 0; draw < 400; ++draw) {
    const Vector drawn = DrawEffects(setup, setup.rest, random);
    for (const int index : setup.free) {
      const Parameter& p = setup.parameters[static_cast<std::size_t>(index)];
      if (p.kind != ParameterKind::kEffect) {
        EXPECT_EQ(drawn[index], setup.rest[index]);
        continue;
      }
      const double share = std::abs(drawn[index] - p.null_value) / (p.upper - p.null_value);
      EXPECT_GE(share, 0.0099);
      near += share < 0.1 ? 1 : 0;
      far += share >= 0.1 ? 1 : 0;
    }
  }
  // Uniform in the logarithm: half of the draws in each decade, five standard deviations.
  EXPECT_NEAR(near, far, 100);
}

// The order in which threads make the searches is chance.
TEST(ManyStarts, TheBestOneDoesNotDependOnTheOrderOfTheSearches) {
  LinearLaws::Truth truth;
  truth.effects = {{"stretch_size", 1.5}};
  const LinearLaws problem(truth, 1, 4, 0, 50);
  const FitSetup setup = SetupWith(problem, "stretch");
  const LeastSquares fit(problem, setup);
  Random random(3);
  std::vector<Vector> starts;
  for (int turn = 0; turn < 6; ++turn) starts.push_back(DrawStart(setup, setup.rest, turn, random));
  ManyStarts forward(fit, starts, 1e-6, 3);
  ManyStarts backward(fit, starts, 1e-6, 3);
  ASSERT_EQ(forward.starts(), 6U);
  for (std::size_t i = 0; i < 6; ++i) {
    forward.Search(i);
    backward.Search(5 - i);
  }
  forward.Shorten();
  backward.Shorten();
  ASSERT_EQ(forward.left(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    forward.Continue(i);
    backward.Continue(2 - i);
  }
  EXPECT_EQ(forward.Best().cost, backward.Best().cost);
  EXPECT_EQ(forward.Best().x, backward.Best().x);
  // Lower than, or as low as, every one of the searches alone.
  for (const Vector& start : starts) {
    solvers::LocalFit alone(fit);
    EXPECT_LE(forward.Best().cost, alone.Minimize(fit.Variables(start), -1, {0, 1e-6}, 8).cost);
  }
}

}  // namespace
}  // namespace sinew::diagnosis
