// Nuisance values of held-out trials, where they have many minima.
#include "identify/solvers/held_out_nuisance.h"

#include <gtest/gtest.h>

#include "base/constants.h"
#include "identify/least_squares.h"
#include "identify/role_view.h"
#include "tests/identify/support/random_walk.h"

namespace sinew {
namespace {

constexpr double kOtherSpeed = 0.3;

// One trial of a random walk, held out.
class HeldOutNuisance : public testing::Test {
 protected:
  struct Case {
    explicit Case(std::uint64_t seed) {
      problem.Add("speed", 0.1, 0.5, kWalkSpeed);
      steps = AddRandomWalk(problem, "t", 1, seed);
      held_out.emplace(problem, [](const Block&) { return BlockRole::kValidate; });
      start = MakeFitSetup(problem, {}).value().rest;
    }

    [[nodiscard]] Vector Fit(double speed, FitRecord* record, const solvers::HeldOutSearch& search) const {
      Vector parameters = start;
      parameters[0] = speed;
      return solvers::FitHeldOutNuisance(*held_out, parameters, record, search);
    }

    [[nodiscard]] bool Finds(const Vector& answer) const { return AngleError(answer, 1, steps) < 1; }

    FunctionProblem problem;
    std::optional<RoleView> held_out;
    std::vector<double> steps;
    Vector start;
  };
};

TEST_F(HeldOutNuisance, FollowsTheAnswerOfAnotherModel) {
  constexpr int kTrials = 8;
  int followed = 0;
  int alone = 0;
  for (int seed = 1; seed <= kTrials; ++seed) {
    const Case walk(static_cast<std::uint64_t>(seed));
    solvers::HeldOutSearch search;
    search.in_windows = true;
    const Vector known = walk.Fit(kWalkSpeed, nullptr, search);
    EXPECT_TRUE(walk.Finds(known));
    alone += walk.Finds(walk.Fit(kOtherSpeed, nullptr, {})) ? 1 : 0;
    search = {};
    search.earlier = {known};
    followed += walk.Finds(walk.Fit(kOtherSpeed, nullptr, search)) ? 1 : 0;
  }
  std::printf("of %d trials %d followed, %d alone\n", kTrials, followed, alone);
  EXPECT_GE(followed, kTrials - 2);
  EXPECT_LE(alone, kTrials / 4);
}

TEST_F(HeldOutNuisance, ARecordKeepsTheAnswer) {
  const Case walk(3);
  solvers::HeldOutSearch search;
  search.in_windows = true;
  FitRecord record;
  const Vector first = walk.Fit(kWalkSpeed, &record, search);
  EXPECT_EQ(record.size(), 1U);
  EXPECT_EQ(first, walk.Fit(kWalkSpeed, &record, search));
  EXPECT_EQ(record.size(), 1U);
  search.earlier = {first};
  (void)walk.Fit(kOtherSpeed, &record, search);
  EXPECT_EQ(record.size(), 2U);
}

TEST_F(HeldOutNuisance, EveryTrialIsFittedAloneWithAnyNumberOfThreads) {
  FunctionProblem problem;
  problem.Add("speed", 0.1, 0.5, kWalkSpeed);
  const std::vector<double> first = AddRandomWalk(problem, "a", 1, 3);
  const std::vector<double> second = AddRandomWalk(problem, "b", 1 + kWalkSamples / 2, 4);
  const RoleView held_out(problem, [](const Block&) { return BlockRole::kValidate; });
  const Vector start = MakeFitSetup(problem, {}).value().rest;
  solvers::HeldOutSearch search;
  search.in_windows = true;
  const Vector found = solvers::FitHeldOutNuisance(held_out, start, nullptr, search);
  search.threads = 2;
  EXPECT_EQ(found, solvers::FitHeldOutNuisance(held_out, start, nullptr, search));
  EXPECT_LT(AngleError(found, 1, first), 1);
  EXPECT_LT(AngleError(found, 1 + kWalkSamples / 2, second), 1);
  EXPECT_EQ(found[0], kWalkSpeed);
}

}  // namespace
}  // namespace sinew
