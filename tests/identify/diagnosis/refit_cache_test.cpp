// Models that a selection by likelihood compares, each fitted once.
#include "identify/diagnosis/select/refit_cache.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <string>
#include <vector>

#include "tests/identify/diagnosis/linear_laws.h"

namespace sinew::diagnosis {
namespace {

using Set = RefitCache::Set;

class RefitCacheTest : public testing::Test {
 protected:
  RefitCacheTest()
      : problem_(Hidden(), 5),
        setup_(MakeFitSetup(problem_, {}).value()),
        candidates_(ListCandidates(problem_, setup_)),
        refitter_(problem_, setup_, candidates_, &interrupt_),
        cache_(refitter_, candidates_, refitter_.Fit({}, {setup_.rest}), options_) {}

  static LinearLaws::Truth Hidden() {
    LinearLaws::Truth truth;
    truth.effects = {{"quadratic_size", 0.8}, {"step_size", 0.6}};
    return truth;
  }
  [[nodiscard]] int Of(const std::string& effect) const {
    const auto found = std::find_if(candidates_.begin(), candidates_.end(),
                                    [&](const Candidate& c) { return c.effect == effect; });
    return static_cast<int>(found - candidates_.begin());
  }
  [[nodiscard]] Set Both() const {
    Set both{Of("quadratic"), Of("step")};
    std::sort(both.begin(), both.end());
    return both;
  }
  void Fit(const Set& set) { cache_.Fit({{set, {setup_.rest}}}); }

  LinearLaws problem_;
  FitSetup setup_;
  std::vector<Candidate> candidates_;
  std::atomic<bool> interrupt_{false};
  Refitter refitter_;
  DiagnosisOptions options_;
  RefitCache cache_;
};

TEST_F(RefitCacheTest, EachSetWithOneMemberLessIsFitted) {
  Fit(Both());
  const std::vector<Set> smaller = cache_.FitWithoutEach(Both());
  ASSERT_EQ(smaller.size(), 2u);
  for (const Set& set : smaller) {
    ASSERT_NE(cache_.FindUsable(set), nullptr);
    // Of a linear law the least squares from anywhere.
    const Refit alone = refitter_.Fit(set, {setup_.rest});
    EXPECT_NEAR(cache_.at(set).deviance, alone.deviance, 1e-3);
    EXPECT_GT(cache_.at(set).deviance, cache_.at(Both()).deviance);
  }
}

TEST_F(RefitCacheTest, ASetWhoseRefitMissedItsMinimumIsFittedAgain) {
  const Set quadratic{Of("quadratic")};
  interrupt_ = true;
  Fit(quadratic);
  interrupt_ = false;
  Fit(Both());
  ASSERT_EQ(cache_.FindUsable(quadratic), nullptr);
  cache_.FitWithoutEach(Both());
  EXPECT_NE(cache_.FindUsable(quadratic), nullptr);
}

TEST_F(RefitCacheTest, ASetAtItsMinimumStaysAsItIs) {
  const Set quadratic{Of("quadratic")};
  Fit(quadratic);
  const Vector before = cache_.at(quadratic).point;
  Fit(Both());
  cache_.FitWithoutEach(Both());
  EXPECT_EQ(cache_.at(quadratic).point, before);
}

}  // namespace
}  // namespace sinew::diagnosis
