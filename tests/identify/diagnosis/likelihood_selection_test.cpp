// The parts of the selection by likelihood, on a linear problem: comparison of sets, forward step, rivals.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "identify/diagnosis/select/forward_step.h"
#include "identify/diagnosis/select/rivals.h"
#include "tests/identify/diagnosis/linear_laws.h"

namespace sinew::diagnosis {
namespace {

class LikelihoodSelection : public ::testing::Test {
 protected:
  void Make(const LinearLaws::Truth& truth, std::uint64_t seed = 1) {
    laws_ = std::make_unique<LinearLaws>(truth, seed);
    setup_ = *MakeFitSetup(*laws_, {});
    candidates_ = ListCandidates(*laws_, setup_);
    refitter_ = std::make_unique<Refitter>(*laws_, setup_, candidates_);
    auto scored = ScoreModel(*laws_, candidates_, refitter_->Fit({}, {setup_.rest}), options_.alarm_level, 1);
    ASSERT_TRUE(scored) << scored.error().message;
    base_ = std::make_unique<ScoredModel>(std::move(*scored));
    compare_ = std::make_unique<LikelihoodComparison>(*laws_, *refitter_, candidates_, *base_, options_);
  }
  static LinearLaws::Truth Hidden(const std::string& parameter, double value) {
    LinearLaws::Truth truth;
    truth.effects = {{parameter, value}};
    return truth;
  }
  [[nodiscard]] int Of(const std::string& effect) const {
    for (std::size_t c = 0; c < candidates_.size(); ++c) {
      if (candidates_[c].effect == effect) return static_cast<int>(c);
    }
    return -1;
  }
  const Refit& Fitted(const std::string& effect) {
    compare_->refits().Fit({{{Of(effect)}, {setup_.rest}}});
    return compare_->at({Of(effect)});
  }
  [[nodiscard]] static const Rival* Find(const std::vector<Rival>& rivals, int candidate) {
    const auto found = std::find_if(rivals.begin(), rivals.end(),
                                    [&](const Rival& rival) { return rival.candidate == candidate; });
    return found == rivals.end() ? nullptr : &*found;
  }

  DiagnosisOptions options_;
  FitSetup setup_;
  std::vector<Candidate> candidates_;
  std::unique_ptr<LinearLaws> laws_;
  std::unique_ptr<Refitter> refitter_;
  std::unique_ptr<ScoredModel> base_;
  std::unique_ptr<LikelihoodComparison> compare_;
};

TEST_F(LikelihoodSelection, EveryParameterHasItsPrice) {
  Make({});
  EXPECT_EQ(compare_->Price({}), 0);
  EXPECT_EQ(compare_->Price({Of("drift")}), kPerParameter);
  EXPECT_EQ(compare_->Price({Of("drift"), Of("stretch")}), 3 * kPerParameter);
  const Refit& with = Fitted("drift");
  EXPECT_DOUBLE_EQ(compare_->Penalised(with, base_->refit),
                   with.deviance - base_->refit.deviance + kPerParameter);
}

TEST_F(LikelihoodSelection, ALikelihoodRatioIsJudgedAmongAllCandidates) {
  Make({});
  const std::vector<int> drift{Of("drift")};
  EXPECT_EQ(compare_->PValue(0, drift), 1);
  // 11 would be p = 0.0009 of one candidate alone.
  EXPECT_GT(compare_->PValue(11, drift), 0.002);
  EXPECT_LT(compare_->PValue(60, drift), 0.001);
  EXPECT_GE(compare_->PValue(11, drift), compare_->PValue(15, drift));
}

TEST_F(LikelihoodSelection, ForwardStepAddsWhatIsHidden) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    Make(Hidden("drift_size", 0.02), seed);
    EXPECT_EQ(ForwardStep(*compare_, {}, *base_), std::vector<int>{Of("drift")}) << seed;
  }
}

TEST_F(LikelihoodSelection, ForwardStepAddsNothingWhereNothingIsHidden) {
  int added = 0;
  for (std::uint64_t seed = 11; seed <= 30; ++seed) {
    Make({}, seed);
    added += ForwardStep(*compare_, {}, *base_).empty() ? 0 : 1;
  }
  EXPECT_LE(added, 4);  // 5 % each: more in one of 400 such tests
}

TEST_F(LikelihoodSelection, ASetIsWorthLittleAfterASearchWhereItGainsLittle) {
  Make(Hidden("drift_size", 0.02));
  const Refit with = Fitted("drift");
  EXPECT_FALSE(compare_->GainsTooLittle(base_->refit, base_->refit));
  compare_->CompareAsAfterSearch();
  EXPECT_TRUE(compare_->GainsTooLittle(base_->refit, base_->refit));
  EXPECT_FALSE(compare_->GainsTooLittle(with, base_->refit));
}

TEST_F(LikelihoodSelection, ACauseWithNearlyTheSameTraceIsARival) {
  Make(Hidden("step_size", 0.2));
  Fitted("step");
  const std::vector<int> chosen{Of("step")};
  const auto rivals = FindRivals(*compare_, chosen);
  ASSERT_TRUE(rivals) << rivals.error().message;
  const Rival* twin = Find(*rivals, Of("twin"));
  ASSERT_NE(twin, nullptr);
  EXPECT_EQ(twin->instead_of, Of("step"));
  EXPECT_GT(twin->correlation, 0.97);
  EXPECT_DOUBLE_EQ(twin->delta_lr, twin->refit.deviance - compare_->at(chosen).deviance);
  EXPECT_EQ(Find(*rivals, Of("drift")), nullptr);
  EXPECT_TRUE(std::is_sorted(rivals->begin(), rivals->end(),
                             [](const Rival& a, const Rival& b) { return a.delta_lr < b.delta_lr; }));
}

TEST_F(LikelihoodSelection, ARivalThatFitsBetterReplacesTheCause) {
  LinearLaws::Truth truth = Hidden("step_size", 1);
  truth.noise = 0.02;
  Make(truth);
  Fitted("twin");
  const std::vector<int> wrong{Of("twin")};
  const auto rivals = FindRivals(*compare_, wrong);
  ASSERT_TRUE(rivals) << rivals.error().message;
  EXPECT_EQ(BetterSet(*compare_, wrong, *rivals, {}), std::vector<int>{Of("step")});
  const auto of_right = FindRivals(*compare_, {Of("step")});
  ASSERT_TRUE(of_right) << of_right.error().message;
  EXPECT_TRUE(BetterSet(*compare_, {Of("step")}, *of_right, {}).empty());
}

}  // namespace
}  // namespace sinew::diagnosis
