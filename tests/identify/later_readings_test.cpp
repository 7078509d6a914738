#include "identify/observation/later_readings.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "identify/observation/sensor_effects.h"
#include "tests/identify/support/toy_problem.h"

namespace sinew {
namespace {

constexpr double kRecordStep = 0.001;  // [s]
constexpr std::size_t kPerMean = 16;
constexpr int kMeans = 20;

// Faster than means of sixteen samples show.
double Fast(double t) {
  return std::sin(2 * M_PI * 40 * t) + 3 * t;
}
double FastSlope(double t) {
  return 2 * M_PI * 40 * std::cos(2 * M_PI * 40 * t) + 3;
}

struct Record {
  std::vector<double> time;
  std::vector<double> values;
  std::vector<LaterReadings::Sum> means;
};

// @param late [s] the record's sensor
Record RecordOf(double late) {
  Record record;
  // A mean's worth of samples before the first mean, and one after the last.
  for (std::size_t k = 0; k < (kMeans + 2) * kPerMean; ++k) {
    record.time.push_back(kRecordStep * static_cast<double>(k));
    record.values.push_back(Fast(record.time.back() - late));
  }
  for (int i = 0; i < kMeans; ++i)
    record.means.push_back({i, (static_cast<std::size_t>(i) + 1) * kPerMean,
                            std::vector<double>(kPerMean, 1.0 / static_cast<double>(kPerMean))});
  return record;
}

Vector MeansOf(const Record& record) {
  Vector means(static_cast<Eigen::Index>(record.means.size()));
  for (std::size_t i = 0; i < record.means.size(); ++i) {
    double sum = 0;
    for (std::size_t j = 0; j < kPerMean; ++j)
      sum += record.means[i].coefficients[j] * record.values[record.means[i].begin + j];
    means[static_cast<Eigen::Index>(i)] = sum;
  }
  return means;
}

LaterReadings LaterOf(const Record& record) {
  return {record.time, record.values, record.means};
}

struct Change {
  Vector means{Vector(kMeans)};
  Vector slopes{Vector(kMeans)};
};

Change ChangeOf(const LaterReadings& readings, double later) {
  Change change;
  readings.At(later, change.means, change.slopes);
  return change;
}

TEST(LaterReadings, ALateRecordReadLaterIsThatOfASensorInTime) {
  constexpr double kInterpolation = 2e-3;  // of a cubic between samples of 25 to a period
  for (const double late : {0.0004, -0.0007, 0.0123}) {
    const Record record = RecordOf(late);
    const Vector expected = MeansOf(RecordOf(0)) - MeansOf(record);
    const Change change = ChangeOf(LaterOf(record), late);
    EXPECT_GT(expected.norm(), 0.05) << "there is something to be seen";
    EXPECT_LT((change.means - expected).cwiseAbs().maxCoeff(), kInterpolation) << late;
  }
}

TEST(LaterReadings, NowNothingChangesToTheLastBit) {
  const Change change = ChangeOf(LaterOf(RecordOf(0.0004)), 0);
  EXPECT_TRUE(change.means.isZero(0));
}

TEST(LaterReadings, SlopesAreThoseOfTheMeans) {
  const LaterReadings readings = LaterOf(RecordOf(0));
  for (const double later : {0.0, 0.00031, -0.0052}) {
    constexpr double kStep = 1e-7;
    const Vector expected =
        (ChangeOf(readings, later + kStep).means - ChangeOf(readings, later - kStep).means) / (2 * kStep);
    EXPECT_LT((ChangeOf(readings, later).slopes - expected).norm(), 1e-5 * expected.norm()) << later;
  }
  double slope = 0;
  for (std::size_t k = 0; k < kPerMean; ++k)
    slope += FastSlope(kRecordStep * static_cast<double>(kPerMean + k));
  EXPECT_NEAR(ChangeOf(readings, 0).slopes[0], slope / kPerMean, 0.02 * std::abs(slope / kPerMean) + 0.5);
}

TEST(LaterReadings, WhatIsNotKnownStaysAsBesideIt) {
  Record record = RecordOf(0);
  for (std::size_t k = 0; k < record.time.size(); ++k) record.values[k] = 5;
  // Before the load begins a plate computes no centre of pressure.
  for (std::size_t k = 0; k < kPerMean + 4; ++k) {
    record.values[k] = std::numeric_limits<double>::quiet_NaN();
  }
  for (const double later : {-0.1, -0.003, 0.0005, 10.0}) {
    const Change change = ChangeOf(LaterOf(record), later);
    EXPECT_LT(change.means.cwiseAbs().maxCoeff(), 1e-12) << later;
    EXPECT_LT(change.slopes.cwiseAbs().maxCoeff(), 1e-9) << later;
  }
}

// Means of the fast signal, which the model predicts; its sensor was late.
TEST(LaterReadings, ATimeOffsetExplainsALateSensorExactly) {
  constexpr double kLate = 0.0007;
  const Record record = RecordOf(kLate);
  const Vector in_time = MeansOf(RecordOf(0));
  Block block;
  block.trial = "one";
  block.channel = "y";
  block.unit = "1";
  const Vector measured = MeansOf(record);
  for (int i = 0; i < kMeans; ++i) {
    block.prediction_time.push_back(kRecordStep * static_cast<double>(kPerMean) * (i + 1.5));
    block.sample.push_back(i);
    block.measured.push_back(measured[i]);
  }
  block.later = std::make_shared<LaterReadings>(record.time, record.values, record.means);
  const double first = block.prediction_time.front();
  auto toy = std::make_unique<toy::ToyProblem>(
      std::vector<Parameter>{toy::MakeParameter("amplitude", 0.5, 4, 1)}, Layout{block},
      [&](const Block&, double t, const Vector& p, Vector* gradient) -> Result<double> {
        const double mean =
            in_time[static_cast<Eigen::Index>(std::lround((t - first) / (kRecordStep * kPerMean)))];
        if (gradient != nullptr) (*gradient)[0] = mean;
        return p[0] * mean;
      });
  const SensorEffects problem(std::move(toy));
  const auto workspace = problem.NewWorkspace();
  Prediction prediction(problem.layout());
  const auto error_of = [&](const Vector& p) {
    EXPECT_TRUE(problem.Predict({p, {true}, true, nullptr}, *workspace, prediction));
    return Vector(prediction.values(0) - measured);
  };
  Vector p = RestPoint(problem);
  EXPECT_GT(error_of(p).norm(), 0.1);
  p[1 + kTimeOffset] = kLate;
  EXPECT_LT(error_of(p).cwiseAbs().maxCoeff(), 2e-3);

  // With drift, gain and low-pass: derivatives against differences.
  p[0] = 1.3;
  p[1 + kDrift] = 2;
  p[1 + kGain] = 0.8;
  p[1 + kLowPass] = 0.02;
  error_of(p);
  const Matrix derivatives = prediction.derivatives(0);
  for (const int column : {0, 1 + kDrift, 1 + kGain, 1 + kTimeOffset, 1 + kLowPass}) {
    constexpr double kStep = 1e-6;
    Vector above = p;
    Vector below = p;
    above[column] += kStep;
    below[column] -= kStep;
    const Vector expected = (error_of(above) - error_of(below)) / (2 * kStep);
    EXPECT_LT((derivatives.col(column) - expected).norm(), 1e-5 * expected.norm()) << column;
  }
}

}  // namespace
}  // namespace sinew
