#include "problems/contact/motion/deviation_curves.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/random.h"

namespace sinew {
namespace {

constexpr CurveSpectrum kSmooth{0.15, 0.01};
constexpr CurveSpectrum kRough{0.1, 1};

std::vector<double> Times(double rate, double length) {
  std::vector<double> times;
  for (double t = 0; t <= length + 1e-9; t += 1 / rate) times.push_back(t);
  return times;
}

TEST(DeviationCurves, HaveUnitVarianceAndTheStatedCorrelation) {
  const std::vector<double> times = Times(100, 2);
  const DeviationCurves curves(times, 0, 2, 10);
  for (const CurveSpectrum& spectrum : {kSmooth, kRough, CurveSpectrum{0.3, 1e-6}}) {
    const Matrix value = curves.With(spectrum)->value;
    const Matrix covariance = value * value.transpose();
    EXPECT_NEAR(covariance.trace() / static_cast<double>(times.size()), 1, 0.01);
    double worst = 0;
    for (Eigen::Index i = 20; i + 20 < covariance.rows(); ++i) {
      EXPECT_NEAR(covariance(i, i), 1, 0.05);
      worst = std::max(worst, std::abs(covariance(i, i + 20) - spectrum.Correlation(0.2)));
    }
    EXPECT_LT(worst, 0.05);
  }
}

TEST(DeviationCurves, TheScaleIsTheirStandardDeviation) {
  const DeviationCurves curves(Times(100, 2), 0, 2, 10);
  CurveSpectrum larger = kSmooth;
  larger.scale = 3;
  const auto unit = curves.With(kSmooth);
  const auto scaled = curves.With(larger);
  EXPECT_LT((scaled->value - 3 * unit->value).norm(), 1e-12 * scaled->value.norm());
  EXPECT_LT((scaled->rate - 3 * unit->rate).norm(), 1e-12 * scaled->rate.norm());
  // A curve that both allow is the same at both.
  Vector weights = Vector::Zero(curves.weights());
  weights.head(5) << 1, -1, 0.5, 0.2, 1;
  const Vector carried = curves.Carried(weights, kSmooth, larger);
  EXPECT_LT((scaled->value * carried - unit->value * weights).norm(), 0.03 * (unit->value * weights).norm());
}

TEST(DeviationCurves, NoiseComesToTheCurve) {
  const std::vector<double> times = Times(100, 2);
  const DeviationCurves curves(times, 0, 2, 20);
  CurveSpectrum noisy = kSmooth;
  noisy.scale = 2;
  const auto alone = curves.With(noisy);
  noisy.noise = 0.3;
  noisy.noise_time = 0.05;
  const auto with = curves.With(noisy);
  const Matrix more = with->value * with->value.transpose() - alone->value * alone->value.transpose();
  for (Eigen::Index i = 30; i + 30 < more.rows(); ++i) {
    EXPECT_NEAR(more(i, i), 4 * 0.3, 0.1);
    EXPECT_NEAR(more(i, i + 5), 4 * 0.3 * std::exp(-0.5), 0.1);
    EXPECT_NEAR(more(i, i + 20), 0, 0.05);
  }
}

TEST(DeviationCurves, TheCorrelationTimeIsTheDeviationOverThatOfTheRate) {
  const std::vector<double> times = Times(100, 2);
  const DeviationCurves curves(times, 0, 2, 30);
  for (const CurveSpectrum& spectrum : {kSmooth, kRough}) {
    const auto basis = curves.With(spectrum);
    const double rate = basis->rate.norm() / basis->value.norm();
    // A rate that may jump has frequencies above any cutoff.
    EXPECT_NEAR(1 / rate, spectrum.correlation_time, 0.12 * spectrum.correlation_time);
  }
}

TEST(DeviationCurves, RatesAreTheDerivativesOfTheCurves) {
  const double step = 1e-4;
  const std::vector<double> times = Times(1 / step, 0.6);
  const auto basis = DeviationCurves(times, 0, 0.6, 12).With(kRough);
  const Eigen::Index n = basis->value.rows();
  const Matrix differences = (basis->value.bottomRows(n - 2) - basis->value.topRows(n - 2)) / (2 * step);
  EXPECT_LT((differences - basis->rate.middleRows(1, n - 2)).cwiseAbs().maxCoeff(),
            1e-4 * basis->rate.cwiseAbs().maxCoeff());
}

TEST(DeviationCurves, RatesStretchWithThePhase) {
  const std::vector<double> times = Times(100, 0.6);
  const auto plain = DeviationCurves(times, 0, 0.6, 6).With(kRough);
  const auto stretched = DeviationCurves(times, 0, 0.6, 6, 2).With(kRough);
  EXPECT_EQ(plain->value, stretched->value);
  EXPECT_LT((2 * plain->rate - stretched->rate).norm(), 1e-12 * plain->rate.norm());
  const auto beyond = DeviationCurves({-0.1, 0, 0.6, 0.9}, 0, 0.6, 6).With(kRough);
  EXPECT_EQ(beyond->value.row(0), beyond->value.row(1));
  EXPECT_EQ(beyond->value.row(2), beyond->value.row(3));
  EXPECT_EQ(beyond->rate.row(0).norm() + beyond->rate.row(3).norm(), 0);
}

TEST(DeviationCurves, ASmoothCurveIsTheSameAtARougherPrior) {
  const DeviationCurves curves(Times(100, 0.8), 0, 0.8, 20);
  Random random(3);
  Vector weights(curves.weights());
  for (double& weight : weights) weight = random.Normal();
  const Vector carried = curves.Carried(weights, kSmooth, kRough);
  const Vector before = curves.With(kSmooth)->value * weights;
  const Vector after = curves.With(kRough)->value * carried;
  EXPECT_LT((before - after).norm(), 0.03 * before.norm());
  EXPECT_GT((carried - weights).norm(), 0.1 * weights.norm());
  // A rough one is smoothed, by weights that its prior allows.
  const Vector smoothed = curves.Carried(weights, kRough, {0.3, 1e-6});
  EXPECT_LT(smoothed.cwiseAbs().maxCoeff(), 20);
}

TEST(DeviationCurves, AnyCurveIsTheSameAtAnyPriorWithoutItsLimits) {
  const DeviationCurves curves(Times(100, 0.8), 0, 0.8, 20);
  Random random(3);
  Vector weights(curves.weights());
  for (double& weight : weights) weight = random.Normal();
  const CurveSpectrum smoother{0.3, 1e-6, 2};
  for (const CurveSpectrum& to : {kSmooth, smoother}) {
    const Vector same = curves.SameCurve(weights, kRough, to);
    const Vector before = curves.With(kRough)->value * weights;
    EXPECT_LT((curves.With(to)->value * same - before).norm(), 1e-9 * before.norm());
    EXPECT_GT(same.cwiseAbs().maxCoeff(), 20);
    EXPECT_LT((curves.SameCurve(same, to, kRough) - weights).norm(), 1e-6 * weights.norm());
  }
}

TEST(DeviationCurves, KeepWhatWasAskedForLast) {
  const DeviationCurves curves(Times(100, 0.8), 0, 0.8, 20);
  const auto first = curves.With(kSmooth);
  EXPECT_EQ(curves.With(kSmooth), first);
  for (int k = 1; k < 10; ++k) EXPECT_NE(curves.With({0.1 * k, 0.5}), first);
  EXPECT_EQ(curves.With(kSmooth)->value, first->value);  // made again
}

}  // namespace
}  // namespace sinew
