// The choice among sets of causes by errors of left-out data.
#include "identify/diagnosis/select/choice_of_sets.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numeric>

namespace sinew::diagnosis {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();

TEST(ChoiceOfSets, GeometricMean) {
  EXPECT_NEAR(GeometricMean({1, 4, 16}), 4, 1e-12);
  EXPECT_EQ(GeometricMean({}), kInfinite);
}

TEST(ChoiceOfSets, TheSmallestWithinAQuarterOfTheLeastError) {
  const JudgedSet none{{}, {10, 10, 10, 10}};
  EXPECT_EQ(ChooseSet({none, {{1}, {1.2, 1.2, 1.2, 1.2}}, {{2, 3}, {1, 1, 1, 1}}}), 1U);
  EXPECT_EQ(ChooseSet({none, {{1}, {1.3, 1.3, 1.3, 1.3}}, {{2, 3}, {1, 1, 1, 1}}}), 2U);
}

// Of sets within 5 % of each other: no bound, then common causes, then the error.
TEST(ChoiceOfSets, TiesGoToSetsWithoutBoundsAndToCommonCauses) {
  const JudgedSet none{{}, {10, 10}};
  EXPECT_EQ(ChooseSet({none, {{1}, {1, 1}, 1, 0}, {{2}, {1.04, 1.04}, 0, 2}}), 2U);
  EXPECT_EQ(ChooseSet({none, {{1}, {1, 1}, 0, 2}, {{2}, {1.04, 1.04}, 0, 1}}), 2U);
  EXPECT_EQ(ChooseSet({none, {{1}, {1, 1}, 0, 1}, {{2}, {1.04, 1.04}, 0, 1}}), 1U);
  EXPECT_EQ(ChooseSet({none, {{1}, {1, 1}, 0, 2}, {{2}, {1.06, 1.06}, 0, 0}}), 1U) << "no tie";
}

TEST(ChoiceOfSets, CausesThatBringLittleAreRemoved) {
  // By its error {1, 2} would be chosen: {1} is 30 % worse.
  const JudgedSet none{{}, {10, 10, 10, 10, 10}};
  const JudgedSet both{{1, 2}, {1, 1, 1, 1, 1}};
  EXPECT_EQ(ChooseSet({none, {{1}, {1.3, 1.3, 1.3, 1.3, 1.3}}, both}), 2U);
  // {3} is 12 % worse than {3, 4}, and both are within a quarter of the least error ...
  const JudgedSet least{{5, 6, 7}, {1, 1, 1, 1, 1}};
  const JudgedSet pair{{3, 4}, {1.2, 1.2, 1.2, 1.2, 1.2}};
  EXPECT_EQ(ChooseSet({none, least, pair, {{3}, {1.35, 1.35, 1.35, 1.35, 1.35}}}), 3U);
  // ... or 21 % worse, but by two folds alone.
  EXPECT_EQ(ChooseSet({none, least, pair, {{3}, {1.2, 1.2, 1.2, 1.91, 1.91}}}), 3U);
  EXPECT_EQ(ChooseSet({none, least, pair, {{3}, {1.2, 1.44, 1.44, 1.5, 1.6}}}), 2U);
}

// Without either of {1, 2} the error is three times as large, but another single cause does nearly as well as
// both.
TEST(ChoiceOfSets, ALargerSetMustPredictBetterThanEverySmallerOne) {
  const JudgedSet none{{}, {10, 10, 10}};
  const JudgedSet least{{5, 6, 7}, {1, 1, 1}};
  const JudgedSet pair{{1, 2}, {1.2, 1.2, 1.2}};
  const JudgedSet first{{1}, {3, 3, 3}};
  const JudgedSet second{{2}, {3, 3, 3}};
  EXPECT_EQ(ChooseSet({none, least, pair, first, second, {{3}, {1.35, 1.35, 1.35}}}), 5U);
  EXPECT_EQ(ChooseSet({none, least, pair, first, second, {{3}, {1.6, 1.6, 1.6}}}), 2U);
}

// A cause that halves the error stays, in how few folds it may do so: without it a cascade of removals can
// end with no cause at all.
TEST(ChoiceOfSets, ACauseThatBringsMuchIsKept) {
  const JudgedSet none{{}, {1, 1, 1, 1}};
  EXPECT_EQ(ChooseSet({none, {{1}, {0.9, 0.9, 0.9, 0.9}}, {{1, 2}, {0.91, 0.91, 0.01, 0.01}}}), 2U);
}

TEST(ChoiceOfSets, SharesTellHowFirmTheChoiceIs) {
  const JudgedSet none{{}, {10, 10, 10, 10}};
  const std::vector<double> sure = ChosenShares({none, {{1}, {1, 1, 1, 1}}, {{2}, {2, 2, 2, 2}}}, 1);
  EXPECT_NEAR(sure[1], 1, 1e-9);
  // Each better in half of the folds: which one is chosen depends on the folds that are drawn.
  const std::vector<JudgedSet> even{none, {{1}, {1, 1, 3, 3}}, {{2}, {3, 3, 1, 1}}};
  const std::vector<double> unsure = ChosenShares(even, 1);
  EXPECT_GT(unsure[1], 0.3);
  EXPECT_GT(unsure[2], 0.25);
  EXPECT_NEAR(std::accumulate(unsure.begin(), unsure.end(), 0.0), 1, 1e-9);
  EXPECT_EQ(unsure, ChosenShares(even, 1)) << "of one seed, the same";
}

}  // namespace
}  // namespace sinew::diagnosis
