#include "identify/noise/white_levels.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "base/decompositions.h"
#include "base/random.h"

namespace sinew::noise {
namespace {

constexpr int kObservations = 40;  // of a channel
constexpr int kWeights = 100;      // with priors: more than all samples
constexpr int kFree = 2;           // without

// Two channels of white noise that share smooth random curves and two free regressors.
struct Case {
  std::vector<NoiseBlock> blocks;
  std::vector<PriorRow> priors;
};

Matrix Smooth(Random& random) {
  Matrix curves(kObservations, kFree + kWeights);
  for (Eigen::Index k = 0; k < curves.cols(); ++k) {
    const double frequency = 0.02 + 0.01 * random.Uniform(0, 1);
    const double phase = random.Uniform(0, 6.3);
    for (Eigen::Index t = 0; t < kObservations; ++t)
      curves(t, k) = std::sin(6.283 * frequency * static_cast<double>(t) + phase);
  }
  return curves;
}

Case Draw(Random& random, double first_level, double second_level) {
  Case made;
  Vector weights(kFree + kWeights);
  for (double& weight : weights) weight = random.Normal();
  for (const double level : {first_level, second_level}) {
    NoiseBlock block;
    block.channel = made.blocks.empty() ? "first" : "second";
    block.regressors = Smooth(random);
    block.residual = block.regressors * weights;
    for (double& value : block.residual) value += level * random.Normal();
    for (int k = 0; k < kFree + kWeights; ++k) block.columns.push_back(k);
    block.stretches = {0};
    block.white = true;
    made.blocks.push_back(std::move(block));
  }
  for (int k = kFree; k < kFree + kWeights; ++k) made.priors.push_back({k, 1, 0});
  return made;
}

NoiseModel Levels(double first, double second) {
  NoiseModel model;
  model.channels = {{"first", {}, first, 0}, {"second", {}, second, 0}};
  model.channel_of = {0, 1};
  return model;
}

// -2 log restricted likelihood of the readings, whose covariance is that of the weights' curves and the
// noise.
double DenseDeviance(const Case& of, double first, double second) {
  Matrix all(2 * kObservations, kFree + kWeights);
  Vector readings(2 * kObservations);
  for (int b = 0; b < 2; ++b) {
    const NoiseBlock& block = of.blocks[static_cast<std::size_t>(b)];
    all.middleRows(b * kObservations, kObservations) = block.regressors;
    readings.segment(b * kObservations, kObservations) = block.residual;
  }
  const Matrix random = all.rightCols(kWeights);
  const Matrix fixed = all.leftCols(kFree);
  Matrix covariance = random * random.transpose();
  for (int i = 0; i < kObservations; ++i) {
    covariance(i, i) += first * first;
    covariance(kObservations + i, kObservations + i) += second * second;
  }
  const Matrix precision = covariance.inverse();
  const Matrix information = fixed.transpose() * precision * fixed;
  const Vector pull = fixed.transpose() * precision * readings;
  return std::log(covariance.determinant()) + std::log(information.determinant()) +
         readings.dot(precision * readings) - pull.dot(information.inverse() * pull);
}

TEST(WhiteLevels, TheDevianceIsThatOfTheMarginalCovariance) {
  Random random(3);
  const Case one = Draw(random, 0.5, 1);
  const WhiteLevels levels(one.blocks, one.priors);
  const double difference = levels.Deviance(Levels(0.4, 1.3)) - levels.Deviance(Levels(0.6, 0.9));
  EXPECT_NEAR(difference, DenseDeviance(one, 0.4, 1.3) - DenseDeviance(one, 0.6, 0.9), 1e-5);
}

TEST(WhiteLevels, AreFoundBesideMoreRegressorsThanSamples) {
  constexpr int kCases = 30;
  Random random(4);
  double first = 0;
  double second = 0;
  double left = 0;
  for (int i = 0; i < kCases; ++i) {
    const Case one = Draw(random, 0.5, 1);
    NoiseModelOptions options;
    options.priors = one.priors;
    const auto model = EstimateNoiseModel(one.blocks, options);
    ASSERT_TRUE(model) << model.error().message;
    first += std::pow(model->channels[0].deviation, 2) / kCases;
    second += std::pow(model->channels[1].deviation, 2) / kCases;
    left += (2 * kObservations - model->channels[0].spent - model->channels[1].spent) / kCases;
    // The answer is a minimum of its deviance.
    const WhiteLevels levels(one.blocks, one.priors);
    const double a = model->channels[0].deviation;
    const double b = model->channels[1].deviation;
    for (const double factor : {0.9, 1.1}) {
      EXPECT_GT(levels.Deviance(Levels(factor * a, b)), levels.Deviance(Levels(a, b)));
      EXPECT_GT(levels.Deviance(Levels(a, factor * b)), levels.Deviance(Levels(a, b)));
    }
  }
  // A variance of `degrees` degrees of freedom scatters by sqrt(2 / degrees); four standard errors of the
  // mean.
  const double tolerance = 4 * std::sqrt(2 / (0.5 * left) / kCases);
  EXPECT_NEAR(first / 0.25, 1, tolerance);
  EXPECT_NEAR(second, 1, tolerance);
}

TEST(WhiteLevels, AreNotBelowTheStatedOnes) {
  Random random(5);
  Case one = Draw(random, 0.5, 1);
  one.blocks[0].stated = 2;
  const NoiseModel model = WhiteLevels(one.blocks, one.priors).Estimate(nullptr);
  EXPECT_EQ(model.channels[0].deviation, 2);
  EXPECT_LT(model.channels[1].deviation, 2);
}

}  // namespace
}  // namespace sinew::noise
