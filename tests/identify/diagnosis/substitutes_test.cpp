// Effects of which now the one, now the other is chosen are alternatives.
#include "identify/diagnosis/select/substitutes.h"

#include <gtest/gtest.h>

#include <vector>

namespace sinew::diagnosis {
namespace {

TEST(Substitutes, ACandidateTakesTurnsWithTheCauseThatItIsChosenInsteadOf) {
  constexpr int kCause = 1;
  constexpr int kRelative = 2;
  constexpr int kOften = 3;
  const std::vector<FittedSet> judged{FittedSet({kCause}), FittedSet({kRelative}),
                                      FittedSet({kCause, kOften}), FittedSet({kRelative, kOften})};
  EXPECT_TRUE(TakesTurns(kRelative, kCause, judged, {0.4, 0.2, 0.3, 0.1}));
  EXPECT_TRUE(TakesTurns(kCause, kRelative, judged, {0.4, 0.2, 0.3, 0.1}));
  EXPECT_FALSE(TakesTurns(kOften, kCause, judged, {0.4, 0.2, 0.3, 0.1})) << "chosen beside it, too";
  EXPECT_FALSE(TakesTurns(kRelative, kCause, judged, {0.6, 0.05, 0.35, 0})) << "too rarely";
  EXPECT_FALSE(TakesTurns(kRelative, kCause, judged, {0.6, 0, 0.4, 0}));
}

}  // namespace
}  // namespace sinew::diagnosis
