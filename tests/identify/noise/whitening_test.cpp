#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "base/decompositions.h"
#include "identify/noise/autoregression.h"
#include "identify/noise/noise_model.h"

namespace sinew::noise {
namespace {

constexpr double kRounding = 1e-12;

Matrix SomeRows(int rows, int columns) {
  Matrix x(rows, columns);
  for (int c = 0; c < columns; ++c) {
    for (int r = 0; r < rows; ++r) x(r, c) = std::sin(1.3 * r * r + 0.7 * c) + 0.1 * r;
  }
  return x;
}

/// Covariance of AR(1): a^|i-j| / (1 - a^2).
Matrix FirstOrderCovariance(double a, int n) {
  Matrix covariance(n, n);
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) covariance(i, j) = std::pow(a, std::abs(i - j)) / (1 - a * a);
  }
  return covariance;
}

TEST(Whitening, LargestRootFollowsFromTheNoiseMemory) {
  Block block;
  for (int i = 0; i < 10; ++i) {
    block.prediction_time.push_back(0.01 * i);
    if (i % 2 == 0) block.sample.push_back(i);
  }
  EXPECT_EQ(LargestRoot(block), 1);
  block.noise_memory = 0.1;
  EXPECT_NEAR(LargestRoot(block), std::exp(-0.2), kRounding) << "by the samples that are compared";
}

TEST(Autoregression, PartialAndCoefficientsAreInverse) {
  const std::vector<double> partial = {0.9, -0.5, 0.3, 0.05, -0.7};
  const std::vector<double> back = PartialFromCoefficients(CoefficientsFromPartial(partial));
  for (std::size_t i = 0; i < partial.size(); ++i) EXPECT_NEAR(back[i], partial[i], kRounding);
  // AR(2) in closed form: first partial is a1 / (1 - a2), second a2.
  const std::vector<double> second = PartialFromCoefficients({1.6, -0.68});
  EXPECT_NEAR(second[0], 1.6 / 1.68, kRounding);
  EXPECT_NEAR(second[1], -0.68, kRounding);
}

TEST(Autoregression, FilterIsTheInverseCholeskyFactor) {
  constexpr int kSamples = 12;
  const Matrix covariance = FirstOrderCovariance(0.8, kSamples);
  const AutoregressiveFilter filter({0.8});
  const Matrix lower = covariance.llt().matrixL();
  const Matrix x = SomeRows(kSamples, 3);
  Matrix white = x;
  for (int c = 0; c < 3; ++c) filter.Apply(white.col(c).data(), kSamples);
  const Matrix expected = lower.triangularView<Eigen::Lower>().solve(x);
  EXPECT_LT((white - expected).cwiseAbs().maxCoeff(), kRounding);
  EXPECT_NEAR(filter.LogDeterminant(kSamples), 2 * lower.diagonal().array().log().sum(), kRounding);
}

TEST(Autoregression, HigherOrdersGiveUnitCovariance) {
  // Autocovariances by the sum over the impulse response, an independent route.
  const std::vector<double> partial = {0.7, -0.4, 0.5};
  const std::vector<double> a = CoefficientsFromPartial(partial);
  constexpr int kTerms = 4000;
  std::vector<double> impulse(kTerms);
  impulse[0] = 1;
  for (std::size_t t = 1; t < kTerms; ++t) {
    for (std::size_t i = 0; i < a.size() && i < t; ++i) impulse[t] += a[i] * impulse[t - 1 - i];
  }
  constexpr int kSamples = 9;
  Matrix covariance(kSamples, kSamples);
  for (int i = 0; i < kSamples; ++i) {
    for (int j = 0; j < kSamples; ++j) {
      const auto lag = static_cast<std::size_t>(std::abs(i - j));
      double sum = 0;
      for (std::size_t t = 0; t + lag < kTerms; ++t) sum += impulse[t] * impulse[t + lag];
      covariance(i, j) = sum;
    }
  }
  const AutoregressiveFilter filter(partial);
  Matrix half = covariance;
  for (int c = 0; c < kSamples; ++c) filter.Apply(half.col(c).data(), kSamples);
  Matrix unit = half.transpose();
  for (int c = 0; c < kSamples; ++c) filter.Apply(unit.col(c).data(), kSamples);
  EXPECT_LT((unit - Matrix::Identity(kSamples, kSamples)).cwiseAbs().maxCoeff(), 1e-10);
  const ChannelNoiseModel channel{"force", a, 2};
  EXPECT_NEAR(channel.ProcessDeviation(), 2 * std::sqrt(covariance(0, 0)), 1e-10);
}

TEST(ChannelNoiseModel, RootsAndStationarity) {
  EXPECT_EQ((ChannelNoiseModel{"x", {}, 3}).LargestRoot(), 0);
  EXPECT_EQ((ChannelNoiseModel{"x", {}, 3}).ProcessDeviation(), 3);
  EXPECT_NEAR((ChannelNoiseModel{"x", {-0.9}, 1}).LargestRoot(), 0.9, kRounding);
  EXPECT_NEAR((ChannelNoiseModel{"x", {1.6, -0.68}, 1}).LargestRoot(), std::sqrt(0.68), kRounding);
  EXPECT_TRUE(std::isinf((ChannelNoiseModel{"x", {1.01}, 1}).ProcessDeviation()));
}

TEST(Whitening, DoesNotPredictAcrossGaps) {
  NoiseModel model;
  model.channels = {{"force", {0.5, 0.2}, 2}, {"speed", {}, 4}};
  model.channel_of = {0, 1};
  const Whitening whitening(model, {{0, 5}, {0}});
  const Matrix x = SomeRows(11, 2);
  Matrix white = x;
  whitening.Apply(0, white);
  for (const int t : {2, 3, 4, 7, 8, 10}) {
    EXPECT_NEAR(white(t, 1), (x(t, 1) - 0.5 * x(t - 1, 1) - 0.2 * x(t - 2, 1)) / 2, kRounding) << t;
  }
  // Each stretch like a separate block.
  const Whitening alone(model, {{0}, {0}});
  Matrix second = x.bottomRows(6);
  alone.Apply(0, second);
  EXPECT_EQ(white.bottomRows(6), second);
  Matrix plain = x;
  whitening.Apply(1, plain);
  EXPECT_LT((plain - x / 4).cwiseAbs().maxCoeff(), kRounding);
}

Block BlockAt(const std::vector<double>& times) {
  Block block;
  for (std::size_t i = 0; i < times.size(); ++i) {
    block.prediction_time.push_back(times[i]);
    block.sample.push_back(static_cast<int>(i));
  }
  return block;
}

TEST(Stretches, SplitAtGapsOnly) {
  EXPECT_EQ(Stretches(BlockAt({0, 1, 2, 3, 6, 7, 8, 30, 31})), (std::vector<int>{0, 4, 7}));
  EXPECT_EQ(Stretches(BlockAt({5})), std::vector<int>{0});
  // Samples that were left out of a grid.
  Block block = BlockAt({0, 1, 2, 3, 4, 5, 6, 7, 8, 9});
  block.sample = {0, 1, 2, 5, 6, 7, 8, 9};
  EXPECT_EQ(Stretches(block), (std::vector<int>{0, 3}));
}

TEST(Stretches, JitterIsNoGap) {
  // As a servo on a serial bus: mostly 20.5 ms, some late by up to 87 %.
  std::vector<double> times = {0};
  for (int i = 1; i < 300; ++i) times.push_back(times.back() + (i % 23 == 0 ? 0.0384 : 0.0205));
  EXPECT_EQ(Stretches(BlockAt(times)), std::vector<int>{0});
}

}  // namespace
}  // namespace sinew::noise
