#include "identify/error_concentration.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "base/random.h"
#include "tests/identify/support/toy_problem.h"

namespace sinew {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr int kSamples = 1000;

std::vector<Concentration> Found(const std::function<double(int)>& error) {
  Layout layout{toy::MakeBlock("walk", "moment", kSamples, 1)};
  Vector values(layout[0].predictions());
  layout[0].measured.assign(kSamples, 0);
  for (int i = 0; i < kSamples; ++i) values[layout[0].sample[static_cast<std::size_t>(i)]] = error(i);
  return FindConcentrations(layout, {values});
}

TEST(Concentration, NoiseAndRecurringErrorsAreNone) {
  Random random(3);
  EXPECT_THAT(Found([&](int) { return random.Normal(); }), IsEmpty());
  EXPECT_THAT(Found([](int i) { return i % 250 < 20 ? 5.0 : 0.1; }), IsEmpty()) << "four strides";
  EXPECT_THAT(Found([](int) { return 0.0; }), IsEmpty());
}

TEST(Concentration, OneBadStretchIsFoundWhereItIs) {
  Random random(3);
  const auto found = Found([&](int i) { return random.Normal() + (i >= 600 && i < 640 ? 8 : 0); });
  ASSERT_EQ(found.size(), 1U);
  const auto time = toy::MakeBlock("walk", "moment", kSamples, 1).prediction_time;
  EXPECT_NEAR(found[0].time, time[620], time[10] - time[0]);
  EXPECT_NEAR(found[0].share, 40 * 65.0 / (40 * 65 + 960), 0.05);
  const Warning warning = ToWarning(found[0]);
  EXPECT_EQ(warning.kind, WarningKind::kErrorConcentration);
  EXPECT_THAT(warning.names, ElementsAre("moment", "walk"));
  EXPECT_THAT(warning.numbers, ElementsAre(found[0].share, found[0].width, found[0].time));
}

TEST(Concentration, SeveralAreToldTogether) {
  Layout layout;
  std::vector<Vector> values;
  for (const char* trial : {"a", "b", "c"}) {
    layout.push_back(toy::MakeBlock(trial, "moment", kSamples, 1));
    layout.back().measured.assign(kSamples, 0);
    values.emplace_back(Vector::Constant(layout.back().predictions(), 0.1));
  }
  for (int i = 0; i < 30; ++i) {
    values[0][layout[0].sample[static_cast<std::size_t>(300 + i)]] = 2;
    values[1][layout[1].sample[static_cast<std::size_t>(600 + i)]] = 5;
  }
  // A drift: an event at the end that has grown all the time.
  for (int i = 0; i < kSamples; ++i)
    values[2][layout[2].sample[static_cast<std::size_t>(i)]] = std::exp(0.008 * i);
  const auto found = FindConcentrations(layout, values);
  ASSERT_EQ(found.size(), 2U);
  const auto& event = found[found[0].drift ? 1 : 0];
  const auto& drift = found[found[0].drift ? 0 : 1];
  EXPECT_EQ(event.trial, "b");
  ASSERT_EQ(event.others.size(), 1U);
  EXPECT_EQ(event.others[0].trial, "a");
  const Warning warning = ToWarning(event);
  EXPECT_THAT(warning.names, ElementsAre("moment", "b", "moment", "a"));
  EXPECT_EQ(warning.numbers.size(), 6U);
  EXPECT_TRUE(drift.drift);
  EXPECT_EQ(drift.trial, "c");
  EXPECT_EQ(ToWarning(drift).kind, WarningKind::kErrorDrift);
}

TEST(Concentration, IsFoundAtTheEndsToo) {
  for (const int begin : {0, kSamples - 30}) {
    const auto found = Found([&](int i) { return i >= begin && i < begin + 30 ? 8.0 : 1.0; });
    ASSERT_EQ(found.size(), 1U) << begin;
  }
}

}  // namespace
}  // namespace sinew
