#include "identify/noise/noise_model.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <vector>

#include "base/decompositions.h"
#include "tests/identify/noise/noise_cases.h"

namespace sinew::noise {
namespace {

const NoiseProcess kWhite;
const NoiseProcess kFirstOrder = {{0.9}, {}, 0};
// The criterion that finds the true order almost always, if there is one.
const NoiseModelOptions kConsistent = {6, OrderCriterion::kBic, false, nullptr, {}};

NoiseModel Estimated(const std::vector<NoiseBlock>& blocks, const NoiseModelOptions& options = {}) {
  auto model = EstimateNoiseModel(blocks, options);
  EXPECT_TRUE(model) << model.error().message;
  return model ? *model : NoiseModel();
}

/// A plain autoregression of the least-squares residual.
std::vector<NoiseBlock> WithoutRegressors(std::vector<NoiseBlock> blocks) {
  const Matrix design = StackedRegressors(blocks);
  Vector residual = StackedResiduals(blocks);
  residual -= design * design.colPivHouseholderQr().solve(residual);
  Eigen::Index first = 0;
  for (NoiseBlock& block : blocks) {
    block.residual = residual.segment(first, block.residual.size());
    first += block.residual.size();
    block.regressors.resize(block.residual.size(), 0);
    block.columns.clear();
  }
  return blocks;
}

/// -2 log restricted likelihood by dense algebra, from the covariance itself: an independent route.
double DenseDeviance(const std::vector<NoiseBlock>& blocks, const NoiseModel& model) {
  const Matrix x = StackedRegressors(blocks);
  const Vector r = StackedResiduals(blocks);
  Matrix covariance = Matrix::Zero(r.size(), r.size());
  Eigen::Index first = 0;
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    const ChannelNoiseModel& channel = model.channels[static_cast<std::size_t>(model.channel_of[b])];
    const auto n = static_cast<int>(blocks[b].residual.size());
    // Autocovariance from the impulse response.
    std::vector<double> impulse(3000);
    impulse[0] = channel.deviation;
    for (std::size_t t = 1; t < impulse.size(); ++t) {
      for (std::size_t i = 0; i < channel.coefficients.size() && i < t; ++i) {
        impulse[t] += channel.coefficients[i] * impulse[t - 1 - i];
      }
    }
    std::vector<int> starts = blocks[b].stretches;
    starts.push_back(n);
    for (std::size_t s = 0; s + 1 < starts.size(); ++s) {
      for (int i = starts[s]; i < starts[s + 1]; ++i) {
        for (int j = starts[s]; j < starts[s + 1]; ++j) {
          const auto lag = static_cast<std::size_t>(std::abs(i - j));
          for (std::size_t t = 0; t + lag < impulse.size(); ++t) {
            covariance(first + i, first + j) += impulse[t] * impulse[t + lag];
          }
        }
      }
    }
    first += n;
  }
  const Eigen::LLT<Matrix> root(covariance);
  const Matrix gram = x.transpose() * root.solve(x);
  const Vector right = x.transpose() * root.solve(r);
  const Vector fitted = gram.ldlt().solve(right);
  const Vector left = r - x * fitted;
  return 2 * Matrix(root.matrixL()).diagonal().array().log().sum() + left.dot(root.solve(left)) +
         2 * Matrix(gram.llt().matrixL()).diagonal().array().log().sum();
}

/// The same trial twice over: two channels, with gaps, one stretch shorter than twice the order.
std::vector<NoiseBlock> TwoChannels() {
  Random random(21);
  auto blocks = SmoothTrials(random, kFirstOrder, 2, 60, 2, "position");
  for (NoiseBlock& block : SmoothTrials(random, {{0.5, -0.3}, {}, 0}, 2, 50, 2, "force")) {
    block.stretches = {0, 20, 23, 26};
    blocks.push_back(std::move(block));
  }
  return blocks;
}

TEST(RestrictedDeviance, MatchesDenseAlgebra) {
  const auto blocks = TwoChannels();
  NoiseModel model;
  model.channel_of = {0, 0, 1, 1};
  std::vector<double> difference;
  for (const double a : {0.0, 0.4, 0.95}) {
    model.channels = {{"position", {a, -0.2}, 1 + a}, {"force", {0.4, -0.2, a / 2}, 0.5}};
    difference.push_back(RestrictedDeviance(blocks, model) - DenseDeviance(blocks, model));
  }
  // The constant that is left out depends on the regressors only; deviances here are a few hundred.
  EXPECT_NEAR(difference[1], difference[0], 1e-8);
  EXPECT_NEAR(difference[2], difference[0], 1e-8);
}

TEST(NoiseModel, IsTheMinimumOfTheRestrictedDeviance) {
  const auto blocks = TwoChannels();
  const NoiseModel model = Estimated(blocks);
  const double least = RestrictedDeviance(blocks, model);
  ASSERT_EQ(model.channels.size(), 2);
  for (std::size_t c = 0; c < 2; ++c) {
    for (const double sign : {-1.0, 1.0}) {
      NoiseModel other = model;
      other.channels[c].deviation *= 1 + sign * 0.02;
      EXPECT_GT(RestrictedDeviance(blocks, other), least);
      for (std::size_t i = 0; i < model.channels[c].coefficients.size(); ++i) {
        other = model;
        other.channels[c].coefficients[i] += sign * 0.01;
        EXPECT_GT(RestrictedDeviance(blocks, other), least);
      }
    }
  }
}

TEST(NoiseModel, FittedRegressorsDoNotBiasIt) {
  constexpr int kCases = 300;
  double sum = 0;
  double squares = 0;
  double plain = 0;
  NoiseModelOptions first_order;
  first_order.largest_order = 1;
  for (int i = 0; i < kCases; ++i) {
    Random random(static_cast<std::uint64_t>(1000 + i));
    const auto blocks = SmoothTrials(random, kFirstOrder, 4, 1000, 3);
    const double a = Estimated(blocks, first_order).channels[0].coefficients.at(0);
    sum += a;
    squares += a * a;
    plain += Estimated(WithoutRegressors(blocks), first_order).channels[0].coefficients.at(0);
  }
  const double mean = sum / kCases;
  const double error = std::sqrt((squares / kCases - mean * mean) / kCases);
  plain /= kCases;
  std::printf("AR(1) 0.9, 11 regressors: restricted %.5f +- %.5f, of the plain residual %.5f\n", mean, error,
              plain);
  // Maximum likelihood without any regressor has the bias -2 a / n (White 1961), here -0.00045.
  EXPECT_NEAR(mean, 0.9 - 2 * 0.9 / 4000, 2 * error);
  // The plain one is off by ten standard errors.
  EXPECT_LT(plain, 0.9 - 10 * error);
}

TEST(NoiseModel, WhiteNoiseHasOrderZero) {
  constexpr int kCases = 200;
  int white = 0;
  for (int i = 0; i < kCases; ++i) {
    Random random(static_cast<std::uint64_t>(5000 + i));
    white += Estimated(SmoothTrials(random, kWhite, 4, 250, 3), kConsistent).IsColoured() ? 0 : 1;
  }
  EXPECT_GT(white, 0.95 * kCases);
}

TEST(NoiseModel, WhitensAndFindsTheOrder) {
  int right = 0;
  constexpr int kCases = 50;
  for (int i = 0; i < kCases; ++i) {
    Random random(static_cast<std::uint64_t>(300 + i));
    const auto blocks = SmoothTrials(random, {{1.2, -0.7, 0.3}, {}, 0}, 4, 1000, 3);
    const NoiseModel model = Estimated(blocks, kConsistent);
    right += model.channels[0].coefficients.size() == 3 ? 1 : 0;
    EXPECT_LT(model.channels[0].LargestRoot(), 1);
    const Whitening whitening(model, {{0}, {0}, {0}, {0}});
    double power = 0;
    std::vector<double> lagged(5, 0);
    for (int b = 0; b < 4; ++b) {
      Matrix white = blocks[static_cast<std::size_t>(b)].residual;
      whitening.Apply(b, white);
      power += white.squaredNorm();
      for (int lag = 1; lag <= 5; ++lag) {
        lagged[static_cast<std::size_t>(lag - 1)] +=
            white.col(0).head(1000 - lag).dot(white.col(0).tail(1000 - lag));
      }
    }
    // 4000 samples: an autocorrelation has the deviation 0.016, the mean square 0.022; 4.5 of them, since 300
    // are looked at.
    EXPECT_NEAR(power / 4000, 1, 0.1) << i;
    for (const double sum : lagged) EXPECT_NEAR(sum / power, 0, 0.071) << i;
  }
  EXPECT_GE(right, 0.9 * kCases);
}

// The default order is chosen for noise that is not an autoregression of any order. With BIC and six
// coefficients the variance here is 1.65.
TEST(NoiseModel, ScoresKeepTheirVarianceUnderOtherNoise) {
  constexpr int kCases = 100;
  constexpr int kColumns = 6;
  constexpr int kSamples = 250;
  double sum = 0;
  for (int i = 0; i < kCases; ++i) {
    Random random(static_cast<std::uint64_t>(9000 + i));
    const auto blocks = SmoothTrials(random, {{}, {1, 1, 1, 1, 1}, 0}, 4, kSamples, 3);
    const Matrix design = StackedRegressors(blocks);
    Matrix all(design.rows(), design.cols() + kColumns + 1);
    for (int k = 0; k < kColumns; ++k) {
      for (int b = 0; b < 4; ++b) {
        all.col(design.cols() + k).segment(b * kSamples, kSamples) = SmoothSignal(random, kSamples);
      }
    }
    all.leftCols(design.cols()) = design;
    all.rightCols(1) = StackedResiduals(blocks);
    const Whitening whitening(Estimated(blocks), {{0}, {0}, {0}, {0}});
    for (int b = 0; b < 4; ++b) whitening.Apply(b, all.middleRows(b * kSamples, kSamples));
    const Matrix base = all.leftCols(design.cols());
    Matrix rest = all.rightCols(kColumns + 1);
    const Eigen::ColPivHouseholderQR<Matrix> qr(base);
    for (int k = 0; k < rest.cols(); ++k) rest.col(k) -= base * qr.solve(Vector(rest.col(k)));
    for (int k = 0; k < kColumns; ++k) {
      sum += std::pow(rest.col(k).dot(rest.col(kColumns)) / rest.col(k).norm(), 2);
    }
  }
  // Three standard errors of a variance from 600 scores.
  EXPECT_NEAR(sum / (kCases * kColumns), 1, 3 * std::sqrt(2.0 / (kCases * kColumns)));
}

// A free decay from the initial state solves a difference equation. A likelihood that is conditional on the
// first samples has no lower bound there.
TEST(NoiseModel, FreeDecaysAreNotMistakenForNoise) {
  for (int i = 0; i < 20; ++i) {
    Random random(static_cast<std::uint64_t>(40 + i));
    auto blocks = SmoothTrials(random, {{0.5}, {}, 0}, 4, 100, 0);
    for (NoiseBlock& block : blocks) {
      for (int t = 0; t < 100; ++t) {
        block.regressors(t, 0) = std::pow(0.97, t) * std::cos(0.3 * t);
        block.regressors(t, 1) = std::pow(0.97, t) * std::sin(0.3 * t);
      }
    }
    const NoiseModel model = Estimated(blocks);
    EXPECT_LT(model.channels[0].LargestRoot(), 0.85) << i;  // 0.5 with a deviation of 0.045
  }
}

TEST(NoiseModel, ChannelsHaveTheirOwnNoise) {
  Random random(8);
  auto blocks = SmoothTrials(random, {{0.8}, {}, 0}, 2, 1500, 2, "position");
  for (NoiseBlock& block : SmoothTrials(random, kWhite, 2, 1500, 2, "force")) {
    block.residual *= 5;
    blocks.push_back(std::move(block));
  }
  const NoiseModel model = Estimated(blocks, kConsistent);
  EXPECT_EQ(model.channel_of, (std::vector<int>{0, 0, 1, 1}));
  EXPECT_EQ(model.channels[0].channel, "position");
  EXPECT_EQ(model.channels[1].channel, "force");
  ASSERT_EQ(model.channels[0].coefficients.size(), 1);
  // Three deviations, sqrt((1 - a^2) / n) and 1 / sqrt(2 n), n = 3000.
  EXPECT_NEAR(model.channels[0].coefficients[0], 0.8, 3 * std::sqrt(0.36 / 3000));
  EXPECT_NEAR(model.channels[0].deviation, 1, 3 / std::sqrt(6000.0));
  EXPECT_TRUE(model.channels[1].coefficients.empty());
  EXPECT_NEAR(model.channels[1].deviation / 5, 1, 3 / std::sqrt(6000.0));
}

TEST(NoiseModel, GapsAreNotBridged) {
  // Stretches of 7 out of a strongly correlated process, put together: as if they were neighbours, each joint
  // would look like a jump.
  Random random(31);
  NoiseBlock gaps;
  gaps.channel = "position";
  gaps.residual.resize(2800);
  gaps.regressors.resize(2800, 0);
  for (int i = 0; i < 400; ++i) {
    gaps.residual.segment(7 * i, 7) = NoiseProcess{{0.95}, {}, 0}.Draw(random, 7);
    gaps.stretches.push_back(7 * i);
  }
  const NoiseModel model = Estimated({gaps}, kConsistent);
  ASSERT_EQ(model.channels[0].coefficients.size(), 1);
  EXPECT_NEAR(model.channels[0].coefficients[0], 0.95, 3 * std::sqrt((1 - 0.95 * 0.95) / 2800));
  gaps.stretches = {0};
  EXPECT_LT(Estimated({gaps}, kConsistent).channels[0].coefficients[0], 0.9);
}

TEST(NoiseModel, DependentRegressorsCountOnce) {
  Random random(12);
  auto blocks = SmoothTrials(random, kFirstOrder, 2, 300, 2);
  const NoiseModel once = Estimated(blocks, kConsistent);
  for (NoiseBlock& block : blocks) {
    // A combination of two, one of other units, one that is zero.
    const Eigen::Index k = block.regressors.cols();
    block.regressors.conservativeResize(Eigen::NoChange, k + 3);
    block.regressors.col(k) = block.regressors.col(0) - 2 * block.regressors.col(1);
    block.regressors.col(k + 1) = 1e9 * block.regressors.col(0);
    block.regressors.col(k + 2).setZero();
    for (int i = 0; i < 3; ++i) block.columns.push_back(100 + i);
  }
  const NoiseModel again = Estimated(blocks, kConsistent);
  ASSERT_EQ(again.channels[0].coefficients.size(), once.channels[0].coefficients.size());
  // Where the minimiser stops: it is within 1e-8 of a deviance whose curvature is some 1e4.
  EXPECT_NEAR(again.channels[0].deviation, once.channels[0].deviation, 1e-5);
  EXPECT_NEAR(again.channels[0].coefficients[0], once.channels[0].coefficients[0], 1e-5);
}

TEST(NoiseModel, StaysStationaryOnRandomWalksAndCurves) {
  Random random(4);
  auto blocks = SmoothTrials(random, kWhite, 2, 200, 1);
  for (NoiseBlock& block : blocks) {
    for (int t = 1; t < 200; ++t) block.residual[t] += block.residual[t - 1];
  }
  const NoiseModel walk = Estimated(blocks);
  EXPECT_GT(walk.channels[0].LargestRoot(), 0.9);
  EXPECT_LT(walk.channels[0].LargestRoot(), 1);
  for (NoiseBlock& block : blocks) block.residual = SmoothSignal(random, 200);
  const NoiseModel curve = Estimated(blocks);
  EXPECT_LT(curve.channels[0].LargestRoot(), 1);
  EXPECT_TRUE(std::isfinite(curve.channels[0].ProcessDeviation()));
}

TEST(NoiseModel, FewSamplesAreAnErrorOrWhite) {
  Random random(2);
  NoiseBlock square;
  square.channel = "position";
  square.residual = Vector::Ones(5);
  square.regressors = Matrix::Identity(5, 5);
  square.columns = {0, 1, 2, 3, 4};
  square.stretches = {0};
  const auto model = EstimateNoiseModel({square}, {});
  ASSERT_FALSE(model);
  EXPECT_EQ(model.error().message,
            "5 residuals cannot tell their noise besides 5 fitted values: add samples");
  // Nine degrees of freedom are too few for a coefficient.
  EXPECT_FALSE(Estimated(SmoothTrials(random, kFirstOrder, 1, 14, 3)).IsColoured());
}

TEST(NoiseModel, OptionsAreUsed) {
  Random random(6);
  const auto blocks = SmoothTrials(random, {{0.9}, {}, 1}, 4, 500, 3);
  NoiseModelOptions options;
  options.white = true;
  EXPECT_FALSE(Estimated(blocks, options).IsColoured());
  const auto bic = Estimated(blocks, kConsistent).channels[0].coefficients.size();
  options = kConsistent;
  options.criterion = OrderCriterion::kAic;
  EXPECT_GE(Estimated(blocks, options).channels[0].coefficients.size(), bic);
  options.largest_order = 2;
  EXPECT_LE(Estimated(blocks, options).channels[0].coefficients.size(), 2);
}

// Three short trials, like stances on a force plate, with a constant error.
TEST(NoiseModel, ResidualsAboveTheStatedNoiseGetOrderZero) {
  Random random(11);
  auto blocks = SmoothTrials(random, kWhite, 3, 32, 2);
  for (NoiseBlock& block : blocks) {
    block.residual.array() += 8;
    block.regressors.resize(block.residual.size(), 0);  // the usual regressors could compensate a constant
    block.columns.clear();
  }
  EXPECT_FALSE(Estimated(blocks).channels[0].coefficients.empty()) << "nothing is stated: it may be noise";
  for (NoiseBlock& block : blocks) block.stated = 1;
  const NoiseModel model = Estimated(blocks);
  EXPECT_TRUE(model.channels[0].coefficients.empty());
  EXPECT_NEAR(model.channels[0].deviation, std::hypot(8, 1), 1);
  for (NoiseBlock& block : blocks) block.stated = 8;
  EXPECT_FALSE(Estimated(blocks).channels[0].coefficients.empty()) << "as loud as stated";
  // Coloured noise of the stated level is still described as coloured.
  auto coloured = SmoothTrials(random, kFirstOrder, 4, 1000, 2);
  const NoiseModel free = Estimated(coloured);
  for (NoiseBlock& block : coloured) block.stated = 1 / std::sqrt(1 - 0.81);
  EXPECT_EQ(Estimated(coloured).channels[0].coefficients, free.channels[0].coefficients);
}

TEST(NoiseModel, AChannelWithoutErrorsIsAccepted) {
  Random random(6);
  auto blocks = SmoothTrials(random, kFirstOrder, 1, 400, 1, "position");
  blocks.push_back(SmoothTrials(random, kWhite, 1, 400, 1, "force").front());
  blocks[1].residual.setZero();
  blocks[1].columns = {1, 3, 4};
  const NoiseModel model = Estimated(blocks);
  EXPECT_NEAR(model.channels[0].ProcessDeviation(), 1 / std::sqrt(1 - 0.81), 1.2);  // 3 deviations
  // The error that a regressor of both channels had spread to this one is removed, down to the stated range.
  EXPECT_LT(model.channels[1].ProcessDeviation(), 1e-3);
}

// The reduction of the residual by a fit inside the prediction must not count as a low level or as coloured
// noise.
TEST(NoiseModel, AWhiteBlockHasAtLeastItsStatedLevel) {
  Random random(8);
  std::vector<NoiseBlock> blocks = SmoothTrials(random, kFirstOrder, 4, 200, 3);
  ASSERT_FALSE(Estimated(blocks).channels[0].coefficients.empty());
  for (NoiseBlock& block : blocks) {
    block.white = true;
    block.stated = 1e3;
  }
  const NoiseModel quiet = Estimated(blocks);
  EXPECT_TRUE(quiet.channels[0].coefficients.empty());
  EXPECT_EQ(quiet.channels[0].deviation, 1e3);
  EXPECT_EQ(quiet.channels[0].least_deviation, 1e3);
  // Above the stated level: the estimate.
  for (NoiseBlock& block : blocks) block.stated = 0.1;
  const NoiseModel loud = Estimated(blocks);
  EXPECT_TRUE(loud.channels[0].coefficients.empty());
  EXPECT_NEAR(loud.channels[0].deviation, 1 / std::sqrt(1 - 0.81), 0.7);
  EXPECT_EQ(loud.channels[0].least_deviation, 0.1);
}

TEST(NoiseModel, RootsAreLimitedByTheNoiseMemory) {
  constexpr double kLargest = 0.7;
  Random random(4);
  std::vector<NoiseBlock> blocks = SmoothTrials(random, {{0.5}, {}, 0}, 4, 300, 3);
  blocks[1].residual.array() += 3;  // a trial that lies higher
  const NoiseModel free = Estimated(blocks);
  EXPECT_GT(free.channels[0].LargestRoot(), 0.9) << "it is taken for noise that drifts";
  for (NoiseBlock& block : blocks) block.largest_root = kLargest;
  const NoiseModel held = Estimated(blocks);
  EXPECT_LE(held.channels[0].LargestRoot(), kLargest + 1e-9);
  EXPECT_GT(held.channels[0].LargestRoot(), 0.4);
  // A root below the limit is unchanged.
  blocks[1].residual.array() -= 3;
  const NoiseModel within = Estimated(blocks);
  for (NoiseBlock& block : blocks) block.largest_root = 1;
  EXPECT_NEAR(RestrictedDeviance(blocks, within), RestrictedDeviance(blocks, Estimated(blocks)), 1);
}

TEST(NoiseModel, OrdersOfAGivenModelAreUsed) {
  for (const double largest : {1.0, 0.97}) {
    Random random(5);
    std::vector<NoiseBlock> blocks = SmoothTrials(random, {{1.2, -0.5}, {}, 0}, 3, 300, 3);
    const std::vector<NoiseBlock> other = SmoothTrials(random, kFirstOrder, 3, 300, 3, "speed");
    blocks.insert(blocks.end(), other.begin(), other.end());
    for (NoiseBlock& block : blocks) block.largest_root = largest;
    const NoiseModel chosen = Estimated(blocks);
    NoiseModelOptions options;
    options.like = &chosen;
    for (NoiseBlock& block : blocks) block.residual *= 1.1;
    const NoiseModel kept = Estimated(blocks, options);
    for (std::size_t c = 0; c < 2; ++c) {
      ASSERT_EQ(kept.channels[c].coefficients.size(), chosen.channels[c].coefficients.size());
      EXPECT_NEAR(kept.channels[c].deviation, 1.1 * chosen.channels[c].deviation, 1e-3);
      for (std::size_t i = 0; i < kept.channels[c].coefficients.size(); ++i)
        EXPECT_NEAR(kept.channels[c].coefficients[i], chosen.channels[c].coefficients[i], 5e-3);
    }
  }
}

}  // namespace
}  // namespace sinew::noise
