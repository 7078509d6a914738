#include "models/emg/prediction_error.h"

#include <gtest/gtest.h>

#include <cmath>

namespace sinew {
namespace {

// Deviations -1.5 -0.5 0.5 1.5 and -1.5 0.5 -0.5 1.5: product 4, squares 5 and 5.
TEST(PredictionErrorTest, MatchesAHandCalculation) {
  const PredictionError error = *ComparePrediction({1, 2, 3, 4}, {1, 3, 2, 4});
  EXPECT_NEAR(error.rmse, std::sqrt(0.5), 1e-15);
  EXPECT_NEAR(error.r_squared, 0.64, 1e-14);
}

TEST(PredictionErrorTest, RSquaredIsOfTheShapeAlone) {
  EXPECT_NEAR(ComparePrediction({1, 2, 5}, {12, 14, 20})->r_squared, 1, 1e-14);
  EXPECT_NEAR(ComparePrediction({1, 2, 5}, {-1, -2, -5})->r_squared, 1, 1e-14);  // its sign is lost
  EXPECT_LE(ComparePrediction({0.1, 0.2, 0.7}, {0.3, 0.6, 2.1})->r_squared, 1);
  EXPECT_NEAR(ComparePrediction({1, 2, 1, 2}, {1, 1, 2, 2})->r_squared, 0, 1e-15);
}

TEST(PredictionErrorTest, AConstantHasNoCorrelation) {
  const PredictionError error = *ComparePrediction({0.1, 0.1, 0.1}, {0.2, 0.1, 0.3});
  EXPECT_TRUE(std::isnan(error.r_squared));
  EXPECT_NEAR(error.rmse, std::sqrt(0.05 / 3), 1e-15);
}

TEST(PredictionErrorTest, RejectsSignalsThatCannotBeCompared) {
  const auto message = [](const Result<PredictionError>& made) { return made ? "" : made.error().message; };
  EXPECT_EQ(message(ComparePrediction({1, 2}, {1})),
            "2 predicted values for 1 measured ones, expected as many");
  EXPECT_EQ(message(ComparePrediction({1}, {1})), "1 values, expected at least 2");
  EXPECT_EQ(message(ComparePrediction({1, NAN}, {1, 2})),
            "value 1: nan predicted, 2 measured, expected finite numbers");
}

TEST(PredictionErrorTest, SummaryMatchesAHandCalculation) {
  const ErrorSummary summary = Summarise({{1, 0.5}, {2, NAN}, {6, 0.9}});
  EXPECT_EQ(summary.count, 3U);
  EXPECT_NEAR(summary.rmse, 3, 1e-15);
  EXPECT_NEAR(summary.rmse_deviation, std::sqrt(7), 1e-15);
  EXPECT_EQ(summary.r_squared_count, 2U);
  EXPECT_NEAR(summary.r_squared, 0.7, 1e-15);
  EXPECT_NEAR(summary.r_squared_deviation, std::sqrt(0.08), 1e-15);
  EXPECT_TRUE(std::isnan(Summarise({{1, 0.5}}).rmse_deviation));
  EXPECT_TRUE(std::isnan(Summarise({}).rmse));
}

}  // namespace
}  // namespace sinew
