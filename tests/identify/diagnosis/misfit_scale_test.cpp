// Whether a misfit is large against the noise, on a scale that no model takes part in.
#include "identify/diagnosis/select/misfit_scale.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/random.h"
#include "tests/identify/support/toy_problem.h"

namespace sinew::diagnosis {
namespace {

constexpr double kNoise = 0.01;

// A sine of 1 Hz and of deviation 1 with noise, for ten seconds.
Block Sine(double rate, std::uint64_t seed = 1, double noise = kNoise) {
  Block block = toy::MakeBlock("trial", "angle", static_cast<int>(10 * rate) + 1, 10);
  Random random(seed);
  for (std::size_t i = 0; i < block.measured.size(); ++i)
    block.measured[i] = std::sqrt(2.0) * std::sin(6.28 * block.prediction_time[i]) + noise * random.Normal();
  return block;
}

toy::ToyProblem ProblemWith(Block block) {
  return toy::ToyProblem({}, {std::move(block)},
                         [](const Block&, double, const Vector&, Vector*) -> Result<double> { return 0; });
}

noise::NoiseModel White(double deviation) {
  noise::NoiseModel noise;
  noise.channels.emplace_back();
  noise.channels.back().channel = "angle";
  noise.channels.back().deviation = deviation;
  return noise;
}

TEST(MisfitScale, IsTheStatedNoiseOrThatOfDifferences) {
  Block stated = Sine(100);
  stated.sigma = 0.03;
  stated.weight = 2;
  const toy::ToyProblem first = ProblemWith(stated);
  EXPECT_DOUBLE_EQ(MisfitScale(first).channels()[0].noise, 0.06);
  EXPECT_EQ(MisfitScale(first).channels()[0].source, NoiseSource::kStated);
  const toy::ToyProblem second = ProblemWith(Sine(100));
  EXPECT_NEAR(MisfitScale(second).channels()[0].noise, kNoise, 0.15 * kNoise);
  EXPECT_EQ(MisfitScale(second).channels()[0].source, NoiseSource::kDifferences);
}

TEST(MisfitScale, SaysWhyTheNoiseIsUnknown) {
  const auto of = [](Block block) {
    const toy::ToyProblem problem = ProblemWith(std::move(block));
    return MisfitScale(problem).channels()[0];
  };
  EXPECT_EQ(of(Sine(100)).unknown, NoiseUnknown::kNo);
  const auto none = [&](const Block& block, NoiseUnknown why) {
    EXPECT_EQ(of(block).source, NoiseSource::kNone) << ToString(why);
    EXPECT_STREQ(ToString(of(block).unknown), ToString(why));
    Block stated = block;
    stated.sigma = 0.01;
    EXPECT_EQ(of(stated).unknown, NoiseUnknown::kNo) << ToString(why);
  };
  none(toy::MakeBlock("trial", "angle", 3, 1), NoiseUnknown::kFewSamples);
  none(toy::MakeBlock("trial", "angle", 100, 1), NoiseUnknown::kConstant);
  Block envelope = Sine(100);
  envelope.noise_memory = 0.1;
  none(envelope, NoiseUnknown::kCorrelated);
  // Without noise, and held: every sample ten times.
  EXPECT_EQ(of(Sine(1000, 1, 0)).unknown, NoiseUnknown::kSmooth);
  Block held = Sine(1000);
  for (std::size_t i = 0; i < held.measured.size(); ++i) held.measured[i] = held.measured[i - i % 10];
  EXPECT_EQ(of(held).unknown, NoiseUnknown::kSmooth);
}

// Visible noise counts however small it is; noise that is not visible is no less than a thousandth of the
// signal.
TEST(MisfitScale, IsVisibleNoiseOfAnySize) {
  const auto of = [](double noise) {
    const toy::ToyProblem problem = ProblemWith(Sine(1000, 1, noise));
    return MisfitScale(problem).channels()[0];
  };
  for (const double noise : {1e-4, 1e-5}) {
    EXPECT_EQ(of(noise).unknown, NoiseUnknown::kNo) << noise;
    EXPECT_NEAR(of(noise).noise, noise, 0.15 * noise);
  }
  EXPECT_EQ(of(0).unknown, NoiseUnknown::kSmooth);
  EXPECT_NEAR(of(0).noise, 1e-3, 0.05e-3);
}

TEST(MisfitScale, AConstantChannelMakesNoMisfitLarge) {
  const toy::ToyProblem problem = ProblemWith(toy::MakeBlock("trial", "angle", 100, 1));
  EXPECT_FALSE(MisfitScale(problem).Dominates(White(1e-6)));
}

TEST(MisfitScale, AMisfitDominatesAboveTenTimesTheNoise) {
  const toy::ToyProblem problem = ProblemWith(Sine(100));
  const MisfitScale scale(problem);
  EXPECT_FALSE(scale.Dominates(White(5 * kNoise)));
  EXPECT_TRUE(scale.Dominates(White(15 * kNoise)));
  EXPECT_TRUE(scale.Resembles(White(1.5 * kNoise)));
  EXPECT_FALSE(scale.Resembles(White(6 * kNoise)));
}

TEST(MisfitScale, OnlyKnownNoiseTellsThatNoMoreIsLeft) {
  const toy::ToyProblem visible = ProblemWith(Sine(1000, 1, 1e-4));
  EXPECT_TRUE(MisfitScale(visible).IsNoMore(White(1.3e-4)));
  EXPECT_FALSE(MisfitScale(visible).IsNoise(White(1.3e-4)));
  EXPECT_FALSE(MisfitScale(visible).IsNoMore(White(1.8e-4)));
  EXPECT_TRUE(MisfitScale(visible).IsNoise(White(1.02e-4)));
  const toy::ToyProblem smooth = ProblemWith(Sine(1000, 1, 0));
  EXPECT_FALSE(MisfitScale(smooth).IsNoMore(White(1e-6)));
  EXPECT_FALSE(MisfitScale(smooth).IsNoise(White(1e-6)));
}

// A smooth misfit that an autoregression describes with small innovations is large at any rate.
TEST(MisfitScale, DoesNotDependOnTheSamplingRate) {
  for (const double rate : {50.0, 200.0, 1000.0}) {
    noise::NoiseModel smooth = White(kNoise);
    smooth.channels[0].coefficients = {0.9975};  // deviation of 14 innovations
    const toy::ToyProblem problem = ProblemWith(Sine(rate));
    EXPECT_TRUE(MisfitScale(problem).Dominates(smooth)) << rate;
  }
}

TEST(MisfitScale, StrongAutocorrelationWithSmallInnovationsIsNoNoise) {
  noise::ChannelNoiseModel channel;
  EXPECT_FALSE(StronglyAutocorrelated(channel));
  channel.coefficients = {0.9};  // 2.3 innovations
  EXPECT_FALSE(StronglyAutocorrelated(channel));
  channel.coefficients = {0.975};  // 4.5
  EXPECT_FALSE(StronglyAutocorrelated(channel));
  channel.coefficients = {0.99};  // 7.1
  EXPECT_TRUE(StronglyAutocorrelated(channel));
}

}  // namespace
}  // namespace sinew::diagnosis
