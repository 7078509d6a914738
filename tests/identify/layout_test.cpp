#include "identify/layout.h"

#include <gtest/gtest.h>

#include <limits>

#include "base/constants.h"
#include "tests/identify/support/error_of.h"

namespace sinew {
namespace {

constexpr int kParameters = 4;

Block GoodBlock() {
  Block block;
  block.trial = "walk";
  block.channel = "force";
  block.unit = "N";
  block.prediction_time = {0, 0.5, 1, 1.5};
  block.sample = {0, 2, 3};
  block.measured = {10, 30, 40};
  block.weight = 0.5;
  block.sigma = 2;
  block.columns = {0, 3};
  return block;
}

template <class Change>
std::string ErrorAfter(Change change) {
  Block block = GoodBlock();
  change(block);
  return ErrorOf(CheckLayout({GoodBlock(), block}, kParameters));
}

TEST(Layout, GoodOnesPass) {
  EXPECT_EQ(ErrorOf(CheckLayout({GoodBlock()}, kParameters)), "");
  EXPECT_EQ(ErrorAfter([](Block& b) { b.sigma.reset(); }), "");
  EXPECT_EQ(ErrorAfter([](Block& b) { b.columns.clear(); }), "");
  EXPECT_EQ(ErrorAfter([](Block& b) {
              b.role = BlockRole::kPredicted;
              b.sample.clear();
              b.measured.clear();
            }),
            "");
}

TEST(Layout, ARangeIsOfWhatIsOnlyPredicted) {
  const auto with_range = [](Block& b) {
    b.role = BlockRole::kPredicted;
    b.sample.clear();
    b.measured.clear();
    b.range = Range{0.5, 1.5};
  };
  EXPECT_EQ(ErrorAfter(with_range), "");
  EXPECT_EQ(ErrorAfter([&](Block& b) {
              with_range(b);
              b.range->lower = 1.5;
            }),
            "block walk/force: its range 1.5 .. 1.5 is none");
  EXPECT_EQ(ErrorAfter([](Block& b) { b.range = Range{}; }),
            "block walk/force: it has a range but is measured");
}

TEST(Layout, TimesMustIncrease) {
  EXPECT_EQ(ErrorAfter([](Block& b) { b.prediction_time.clear(); }), "block walk/force: it has no times");
  EXPECT_EQ(ErrorAfter([](Block& b) { b.prediction_time[2] = 0.5; }),
            "block walk/force: time does not increase at 2");
  EXPECT_EQ(ErrorAfter([](Block& b) { b.prediction_time[1] = kNaN; }),
            "block walk/force: time does not increase at 1");
}

TEST(Layout, SamplesMustPointIntoThePredictionInOrder) {
  EXPECT_EQ(ErrorAfter([](Block& b) { b.sample.pop_back(); }),
            "block walk/force: 2 sample indices but 3 measured values");
  EXPECT_EQ(ErrorAfter([](Block& b) { b.sample[0] = -1; }),
            "block walk/force: sample[0] = -1: expected increasing indices into 4 prediction times");
  EXPECT_EQ(ErrorAfter([](Block& b) { b.sample[1] = 0; }),
            "block walk/force: sample[1] = 0: expected increasing indices into 4 prediction times");
  EXPECT_EQ(ErrorAfter([](Block& b) { b.sample[2] = 4; }),
            "block walk/force: sample[2] = 4: expected increasing indices into 4 prediction times");
}

TEST(Layout, MeasuredValuesMustBeThereAndFinite) {
  EXPECT_EQ(ErrorAfter([](Block& b) { b.measured[1] = kNaN; }),
            "block walk/force: measured[1] = nan: expected a finite number (leave gaps out)");
  for (const BlockRole role : {BlockRole::kTrain, BlockRole::kValidate}) {
    EXPECT_EQ(ErrorAfter([&](Block& b) {
                b.role = role;
                b.sample.clear();
                b.measured.clear();
              }),
              "block walk/force: it has no measured value");
  }
}

TEST(Layout, WeightAndNoiseMustBeAboveZero) {
  EXPECT_EQ(ErrorAfter([](Block& b) { b.weight = 0; }), "block walk/force: its weight is 0");
  EXPECT_EQ(ErrorAfter([](Block& b) { b.weight = std::numeric_limits<double>::infinity(); }),
            "block walk/force: its weight is inf");
  EXPECT_EQ(ErrorAfter([](Block& b) { b.sigma = 0; }),
            "block walk/force: its noise level is 0, expected above 0");
  EXPECT_EQ(ErrorAfter([](Block& b) { b.noise_memory = 0; }),
            "block walk/force: its noise is forgotten in 0 s, expected above 0");
}

TEST(Layout, EverySampleHasAGroupOrNoneHas) {
  EXPECT_EQ(ErrorAfter([](Block& b) { b.group.assign(b.measured.size(), 3); }), "");
  EXPECT_EQ(ErrorAfter([](Block& b) { b.group.assign(b.measured.size() + 1, 3); }),
            fmt::format("block walk/force: {} groups of samples but {} measured values",
                        GoodBlock().measured.size() + 1, GoodBlock().measured.size()));
}

TEST(Layout, ColumnsMustBeParametersInOrder) {
  EXPECT_EQ(ErrorAfter([](Block& b) {
              b.columns = {1, 1};
            }),
            "block walk/force: columns[1] = 1: expected increasing indices of the 4 parameters");
  EXPECT_EQ(ErrorAfter([](Block& b) { b.columns = {kParameters}; }),
            "block walk/force: columns[0] = 4: expected increasing indices of the 4 parameters");
  EXPECT_EQ(ErrorAfter([](Block& b) { b.columns = {-1}; }),
            "block walk/force: columns[0] = -1: expected increasing indices of the 4 parameters");
}

TEST(Prediction, HasOnePlacePerBlockAndStartsWithNaN) {
  Block wide = GoodBlock();
  wide.columns = {0, 1, 2};
  wide.prediction_time = {0, 1};
  wide.sample = {0};
  wide.measured = {1};
  Prediction prediction({GoodBlock(), wide});
  ASSERT_EQ(prediction.values(0).size(), 4);
  ASSERT_EQ(prediction.derivatives(0).rows(), 4);
  ASSERT_EQ(prediction.derivatives(0).cols(), 2);
  ASSERT_EQ(prediction.values(1).size(), 2);
  ASSERT_EQ(prediction.derivatives(1).cols(), 3);

  // Entries do not overlap: a value written to one is not read from another.
  prediction.values(0).setConstant(1);
  prediction.derivatives(0).setConstant(2);
  EXPECT_TRUE(prediction.values(1).array().isNaN().all());
  EXPECT_FALSE((prediction.derivatives(1).array() == 2).any());
  prediction.values(1).setConstant(3);
  prediction.derivatives(1).setConstant(4);
  const Prediction& read = prediction;
  EXPECT_TRUE((read.values(0).array() == 1).all());
  EXPECT_TRUE((read.derivatives(0).array() == 2).all());
  EXPECT_TRUE((read.values(1).array() == 3).all());
  EXPECT_TRUE((read.derivatives(1).array() == 4).all());

  prediction.Poison();
  EXPECT_TRUE(read.values(0).array().isNaN().all());
  EXPECT_TRUE(read.derivatives(1).array().isNaN().all());
}

}  // namespace
}  // namespace sinew
