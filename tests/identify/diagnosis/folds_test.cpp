// Parts of the training data that are left out of a fit in turn.
#include "identify/diagnosis/fit/folds.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "tests/identify/diagnosis/linear_laws.h"

namespace sinew::diagnosis {
namespace {

TEST(Folds, AreTheFittedTrialsWhereThereAreFour) {
  const LinearLaws several({}, 1, 4, 2);
  std::vector<std::vector<std::string>> trials;
  for (const Fold& fold : FoldsOf(several)) {
    trials.push_back(fold.trials);
    EXPECT_FALSE(fold.window);
  }
  EXPECT_EQ(trials,
            (std::vector<std::vector<std::string>>{{"trial_1"}, {"trial_2"}, {"trial_3"}, {"trial_4"}}))
      << "held-out trials are no folds";
}

TEST(Folds, ManyTrialsFormTen) {
  const LinearLaws many({}, 1, 23, 1);
  const std::vector<Fold> folds = FoldsOf(many);
  ASSERT_EQ(folds.size(), 10U);
  std::size_t trials = 0;
  for (const Fold& fold : folds) {
    trials += fold.trials.size();
    for (const std::string& trial : fold.trials) EXPECT_TRUE(fold.Has(trial));
    EXPECT_FALSE(fold.Has("trial_24")) << "is held out";
  }
  EXPECT_EQ(trials, 23U);
  EXPECT_EQ(folds.front().trials.size(), 3U);
  EXPECT_EQ(folds.front().trials.front(), "trial_1");
  EXPECT_EQ(folds.back().trials.size(), 2U);
}

TEST(Folds, FewTrialsAreCutIntoWindowsThatHoldEverySampleOnce) {
  for (const int count : {1, 2, 3}) {
    const LinearLaws few({}, 1, count, 1);
    const std::vector<Fold> folds = FoldsOf(few);
    EXPECT_EQ(folds.size(), 6U) << count;
    for (const Block& block : few.layout()) {
      for (std::size_t i = 0; i < block.measured.size(); ++i) {
        int left_out = 0;
        for (const Fold& fold : folds) left_out += fold.LeavesOut(block, i) ? 1 : 0;
        EXPECT_EQ(left_out, block.role == BlockRole::kTrain ? 1 : 0) << block.trial << " " << i;
      }
    }
  }
}

TEST(Folds, AViewOfAWindowLacksItsSamplesAndTheResidualsAreThoseOfThem) {
  const LinearLaws one({}, 1, 1, 1);
  const Fold fold = FoldsOf(one)[2];
  const FoldView view(one, fold);
  const Block& whole = one.layout()[0];
  const Block& rest = view.layout()[0];
  int gone = 0;
  for (std::size_t i = 0; i < whole.measured.size(); ++i) gone += fold.LeavesOut(whole, i) ? 1 : 0;
  EXPECT_GT(gone, 0);
  EXPECT_EQ(rest.samples() + gone, whole.samples());
  EXPECT_EQ(rest.predictions(), whole.predictions()) << "the trajectory goes on";
  EXPECT_EQ(view.layout()[1].role, BlockRole::kPredicted) << "held-out trials are not compared";
  const auto residuals = LeftOutResiduals(one, fold, RestPoint(one), nullptr);
  ASSERT_TRUE(residuals);
  EXPECT_EQ(residuals->size(), gone);
}

// A start that has died away in the rest of the trial is not determined by the rest.
TEST(Folds, TheStartOfATrialIsTiedToThatOfAllDataWhereTheRestDoesNotTellIt) {
  LinearLaws::Truth truth;
  truth.starts = true;
  const LinearLaws one(truth, 1, 1, 0);
  const FitSetup setup = *MakeFitSetup(one, {});
  Vector fitted = RestPoint(one);
  int start = -1;
  for (const int index : setup.free) {
    if (setup.parameters[static_cast<std::size_t>(index)].kind == ParameterKind::kNuisance) start = index;
  }
  ASSERT_GE(start, 0);
  fitted[start] = 0.7;
  const Vector norms = Vector::Constant(static_cast<Eigen::Index>(setup.free.size()), 20);
  const Fold first = FoldsOf(one)[0];
  const FitSetup tied = WithTiedNuisance(setup, first, norms, fitted);
  for (const int index : setup.free) {
    const Parameter& p = tied.parameters[static_cast<std::size_t>(index)];
    ASSERT_EQ(p.prior.has_value(), index == start) << p.name;
    if (!p.prior) continue;
    EXPECT_EQ(p.prior->mean, 0.7);
    // A hundredth of 20 squared, per range squared.
    EXPECT_NEAR(p.prior->standard_deviation, (p.upper - p.lower) / 2, 1e-12);
  }
  Fold whole = first;
  whole.window.reset();
  EXPECT_FALSE(
      WithTiedNuisance(setup, whole, norms, fitted).parameters[static_cast<std::size_t>(start)].prior);
}

TEST(Folds, AViewOfATrialHoldsItOutWithItsParameters) {
  LinearLaws::Truth truth;
  truth.starts = true;
  const LinearLaws several(truth, 2, 4, 0);
  const Fold fold = FoldsOf(several)[1];
  const FoldView view(several, fold);
  EXPECT_EQ(view.layout()[0].role, BlockRole::kTrain);
  EXPECT_EQ(view.layout()[1].role, BlockRole::kValidate);
  const FitSetup setup = *MakeFitSetup(several, {});
  EXPECT_EQ(WithoutLeftOut(setup, fold).free.size(), setup.free.size() - 1) << "the start of that trial";
}

}  // namespace
}  // namespace sinew::diagnosis
