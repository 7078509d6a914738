#include "models/emg/averaged_emg.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/constants.h"
#include "base/random.h"

namespace sinew {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr double kDegree = kPi / 180;

// One muscle. Means at 1 rad/s: 1 3 1, at 2 rad/s: 3 5 1. Shape 2 4 1, peak 4, factors 3/4 and 5/4, line 1/4
// + speed / 2.
std::vector<SpeedCycles> SmallExample() {
  return {{2, {{{2, 6, 0}, {4, 4, 2}}}}, {1, {{{0, 3, 1}, {2, 3, 1}}}}};
}

TEST(AveragedEmgTest, MatchesAHandCalculation) {
  const auto model = AveragedEmg::Build({"m"}, SmallExample(), {});
  ASSERT_TRUE(model) << model.error().message;
  const MuscleAverage& m = model->muscle(0);
  EXPECT_EQ(m.cycles, 4U);
  EXPECT_THAT(m.speeds, ElementsAre(1, 2));
  EXPECT_THAT(m.at_speeds[0].mean, ElementsAre(1, 3, 1));
  EXPECT_THAT(m.at_speeds[1].mean, ElementsAre(3, 5, 1));
  EXPECT_NEAR(m.at_speeds[1].deviation[1], std::sqrt(2), 1e-15);
  EXPECT_THAT(m.shape, ElementsAre(2, 4, 1));
  EXPECT_EQ(m.peak, 4);
  EXPECT_THAT(m.factors, ElementsAre(0.75, 1.25));
  EXPECT_NEAR(model->factor(0).slope(), 0.5, 1e-15);
  EXPECT_NEAR(model->At(0, 3, 0.5), 1.75 * 4, 1e-14);
  EXPECT_NEAR(model->At(0, 1, 0.25), 0.75 * 3, 1e-14);
  // Cycles over their factors: 0 4 4/3, 8/3 4 4/3, 8/5 24/5 0, 16/5 16/5 8/5; about 2 4 1, over 3.
  EXPECT_NEAR(m.spread[0], std::sqrt((4 + 4. / 9 + 4. / 25 + 36. / 25) / 3), 1e-14);
  EXPECT_NEAR(m.spread[1], std::sqrt((0 + 0 + 16. / 25 + 16. / 25) / 3), 1e-14);
  EXPECT_NEAR(m.spread[2], std::sqrt((1. / 9 + 1. / 9 + 1 + 9. / 25) / 3), 1e-14);
  EXPECT_NEAR(model->SpreadAt(0, 3, 1), 1.75 * m.spread[2], 1e-14);
  EXPECT_THAT(model->notes(), IsEmpty());
}

TEST(AveragedEmgTest, PredictsInTime) {
  const auto model = *AveragedEmg::Build({"m"}, SmallExample(), {});
  const auto cycle = model.PredictCycle(0, 3, 2, 2);  // 2 4 1 times 1.75 at 0, 0.5 .. 2 s
  ASSERT_EQ(cycle.size(), 5U);
  const std::vector<double> expected{2, 3, 4, 2.5, 1};
  for (std::size_t k = 0; k < 5; ++k) EXPECT_NEAR(cycle[k], 1.75 * expected[k], 1e-14);
  const auto values =
      model.PredictRecording(0, {0, 1, 1.5, 2, 3, 3.5, 4, 5, 6}, {{1, 1.5, 2, 3}, {3, 4, 5, 1}});
  EXPECT_TRUE(std::isnan(values[0]) && std::isnan(values[8]));
  EXPECT_NEAR(values[1], 1.75 * 2, 1e-14);
  EXPECT_NEAR(values[2], 1.75 * 4, 1e-14);
  EXPECT_NEAR(values[3], 1.75 * 1, 1e-14);
  EXPECT_NEAR(values[4], 0.75 * 2, 1e-14);
  EXPECT_NEAR(values[5], 0.75 * 3, 1e-14);
  EXPECT_NEAR(values[7], 0.75 * 1, 1e-14);
}

TEST(AveragedEmgTest, InterpolationMeetsTheMeasuredPeaks) {
  std::vector<SpeedCycles> speeds = SmallExample();
  speeds.push_back({4, {{{1, 2, 0}, {1, 2, 0}}}});
  AveragedEmgSettings settings;
  settings.law = FactorLaw::kInterpolation;
  const auto model = *AveragedEmg::Build({"m"}, speeds, settings);
  const MuscleAverage& m = model.muscle(0);
  for (std::size_t s = 0; s < 3; ++s) {
    const auto& mean = m.at_speeds[s].mean;
    EXPECT_NEAR(model.At(0, m.speeds[s], 0.5), *std::max_element(mean.begin(), mean.end()), 1e-14);
  }
  EXPECT_NEAR(model.At(0, 3, 0.5), 0.5 * (5 + 2), 1e-14);
}

// The same by other means: all at once, without the library's functions, from recordings in time.
TEST(AveragedEmgTest, AgreesWithAPlainImplementation) {
  Random random(11);
  const std::vector<double> speeds{30, 45, 60, 75, 90, 120};
  std::vector<SpeedCycles> warped;
  std::vector<std::vector<std::vector<double>>> plain_means(2);  // [muscle][speed][k]
  for (const double speed : speeds) {
    SpeedCycles at{speed * kDegree, {{}, {}}};
    for (std::size_t m = 0; m < 2; ++m) {
      std::vector<double> sum(2000, 0);
      for (int c = 0; c < 9; ++c) {
        const double begin = random.Uniform(0, 0.1);
        const double duration = 90 / speed * random.Uniform(0.95, 1.05);
        std::vector<double> time;
        std::vector<double> values;
        for (int k = 0; k / 500.0 < duration + 0.3; ++k) {
          time.push_back(k / 500.0);
          values.push_back(random.Uniform(0, 0.1) +
                           std::pow(std::sin(kPi * (time.back() - begin) / duration), 2));
        }
        at.muscles[m].push_back(*WarpCycle(time, values, begin, begin + duration));
        for (int k = 0; k < 2000; ++k) {
          const double place = (begin + k / 1999.0 * duration) * 500;
          const auto left = static_cast<std::size_t>(place);
          sum[static_cast<std::size_t>(k)] += values[left] * (1 - (place - std::floor(place))) +
                                              values[left + 1] * (place - std::floor(place));
        }
      }
      for (double& value : sum) value /= 9;
      plain_means[m].push_back(sum);
    }
    warped.push_back(at);
  }
  const auto model = *AveragedEmg::Build({"a", "b"}, warped, {});
  for (std::size_t m = 0; m < 2; ++m) {
    std::vector<double> shape(2000, 0);
    for (const auto& mean : plain_means[m])
      for (std::size_t k = 0; k < 2000; ++k) shape[k] += mean[k] / 6;
    double top = 0;
    for (const double value : shape) top = std::max(top, value);
    // The normal equations of factor = a + b v.
    double n = 0, v1 = 0, v2 = 0, f1 = 0, fv = 0;
    for (std::size_t s = 0; s < 6; ++s) {
      double peak = 0;
      for (const double value : plain_means[m][s]) peak = std::max(peak, value);
      const double v = speeds[s];
      n += 1, v1 += v, v2 += v * v, f1 += peak / top, fv += v * peak / top;
    }
    const double b = (n * fv - v1 * f1) / (n * v2 - v1 * v1);
    const double a = (f1 - b * v1) / n;
    for (std::size_t k = 0; k < 2000; ++k) {
      EXPECT_NEAR(model.muscle(m).shape[k], shape[k], 1e-11);
      for (const double v : {30.0, 52.0, 140.0}) {
        EXPECT_NEAR(model.At(m, v * kDegree, static_cast<double>(k) / 1999), (a + b * v) * shape[k], 1e-10);
      }
    }
  }
}

// Cycles that follow the model: the law is recovered to rounding, and predictions at other speeds are exact.
TEST(AveragedEmgTest, PredictsOtherSpeedsOfDataThatFollowTheModel) {
  const auto shape = [](std::size_t k) {
    const double x = static_cast<double>(k) / 1999;
    return 0.02 + std::exp(-0.5 * std::pow((x - 0.3) / 0.08, 2));
  };
  const auto factor = [](double degrees_per_s) { return 0.6 + 0.005 * degrees_per_s; };
  std::vector<SpeedCycles> speeds;
  for (const double v : {30, 45, 60, 90, 120}) {
    SpeedCycles at{v * kDegree, {{}}};
    for (int c = 0; c < 9; ++c) {
      std::vector<double> cycle;
      for (std::size_t k = 0; k < 2000; ++k) cycle.push_back(factor(v) * shape(k));
      at.muscles[0].push_back(cycle);
    }
    speeds.push_back(at);
  }
  for (const auto law : {FactorLaw::kRegression, FactorLaw::kInterpolation}) {
    AveragedEmgSettings settings;
    settings.law = law;
    const auto model = *AveragedEmg::Build({"m"}, speeds, settings);
    for (const double v : {37.0, 75.0, 110.0}) {
      for (std::size_t k = 0; k < 2000; ++k) {
        const double phase = static_cast<double>(k) / 1999;
        EXPECT_NEAR(model.At(0, v * kDegree, phase), factor(v) * shape(k), 2e-12);
        EXPECT_NEAR(model.SpreadAt(0, v * kDegree, phase), 0, 1e-12);
      }
      // Between samples: straight lines, (1 / 1999 / 0.08)^2 / 8.
      const auto cycle = model.PredictCycle(0, v * kDegree, 1.1, 2048);
      for (std::size_t k = 0; k < cycle.size(); ++k) {
        const double x = static_cast<double>(k) / 2048 / 1.1;
        EXPECT_NEAR(cycle[k], factor(v) * (0.02 + std::exp(-0.5 * std::pow((x - 0.3) / 0.08, 2))), 6e-6);
      }
    }
    if (law == FactorLaw::kRegression) {
      EXPECT_NEAR(model.At(0, 180 * kDegree, 0.3), factor(180) * (0.02 + std::exp(0.0)), 1e-5);
      // Without one of the speeds: the same model, up to its own scale.
      std::vector<SpeedCycles> fewer(speeds.begin() + 1, speeds.end());
      const auto other = *AveragedEmg::Build({"m"}, fewer, settings);
      EXPECT_NEAR(other.At(0, 30 * kDegree, 0.3), model.At(0, 30 * kDegree, 0.3), 1e-12);
    }
  }
}

// Normal scatter about the model: of 4 x 9 cycles' standard deviation the relative error is 1 / sqrt(70); its
// mean over 2000 independent samples has 0.3 %, and a bias from the shape (4 cycles' worth) below 2 %.
TEST(AveragedEmgTest, SpreadIsTheScatterOfCycles) {
  Random random(2);
  std::vector<SpeedCycles> speeds;
  for (const double v : {1.0, 2.0, 3.0, 4.0}) {
    SpeedCycles at{v, {{}}};
    for (int c = 0; c < 9; ++c) {
      std::vector<double> cycle;
      for (int k = 0; k < 2000; ++k) cycle.push_back((k == 700 ? 10 : 5 + 0.05 * random.Normal()));
      at.muscles[0].push_back(cycle);
    }
    speeds.push_back(at);
  }
  const auto model = *AveragedEmg::Build({"m"}, speeds, {});
  double sum = 0;
  for (const double value : model.muscle(0).spread) sum += value / 2000;
  EXPECT_NEAR(sum, 0.05, 0.001);
  EXPECT_NEAR(model.muscle(0).spread[700], 0, 1e-12);
}

TEST(AveragedEmgTest, WarnsOutsideOfTheMeasuredSpeeds) {
  std::vector<SpeedCycles> speeds = SmallExample();
  speeds[0].speed = 120 * kDegree;
  speeds[1].speed = 30 * kDegree;
  const auto model = *AveragedEmg::Build({"soleus_r"}, speeds, {});
  EXPECT_EQ(model.RangeWarning(0, 75 * kDegree), "");
  EXPECT_EQ(model.RangeWarning(0, 30 * kDegree), "");
  EXPECT_EQ(model.RangeWarning(0, 120 * kDegree), "");
  EXPECT_EQ(
      model.RangeWarning(0, 150 * kDegree),
      "soleus_r: 150 deg/s lies outside of the measured speeds, 30.0 to 120 deg/s: shape and factor 1.42 "
      "are not supported by data.");
  EXPECT_NE(model.RangeWarning(0, 29 * kDegree), "");
  speeds.pop_back();
  EXPECT_THAT(AveragedEmg::Build({"m"}, speeds, {})->RangeWarning(0, 1),
              HasSubstr("outside of the only measured speed, 120 deg/s"));
}

TEST(AveragedEmgTest, LeavesOutCyclesWithANote) {
  std::vector<SpeedCycles> speeds = SmallExample();  // muscle m
  speeds[0].muscles.push_back({{1, 1, 1}});          // one cycle at 2 rad/s
  speeds[1].muscles.push_back({{1, 2, 3}, {1, 2, 3}});
  speeds[0].muscles.push_back({{0, 0, 0}, {0, 0, 0}});
  speeds[1].muscles.push_back({});
  const auto model = AveragedEmg::Build({"m", "few", "silent"}, speeds, {});
  ASSERT_TRUE(model) << model.error().message;
  EXPECT_THAT(model->notes(),
              ElementsAre("few: 115 deg/s is left out, it has 1 cycle and 2 are wanted.",
                          "silent: 57.3 deg/s is left out, it has 0 cycles and 2 are wanted.",
                          "silent: 115 deg/s is left out, there is no signal in its 2 cycles.",
                          "silent: no speed has enough cycles, it is left out."));
  EXPECT_TRUE(model->has(0) && model->has(1));
  EXPECT_FALSE(model->has(2));
  EXPECT_THAT(model->muscle(1).speeds, ElementsAre(1));
  EXPECT_THAT(model->muscle(1).shape, ElementsAre(1, 2, 3));
  EXPECT_TRUE(std::isnan(model->At(2, 1, 0.5)) && std::isnan(model->SpreadAt(2, 1, 0.5)));
  EXPECT_TRUE(std::isnan(model->PredictCycle(2, 1, 1, 10)[3]));
  EXPECT_TRUE(std::isnan(model->PredictRecording(2, {0.5}, {{0, 0.5, 1, 1}})[0]));
  EXPECT_EQ(model->RangeWarning(2, 100), "");
  AveragedEmgSettings settings;
  settings.fewest_cycles = 1;
  EXPECT_THAT(AveragedEmg::Build({"m", "few", "silent"}, speeds, settings)->muscle(1).speeds,
              ElementsAre(1, 2));
}

TEST(AveragedEmgTest, RejectsWhatIsNoData) {
  const auto message = [](const std::vector<std::string>& muscles, const std::vector<SpeedCycles>& speeds) {
    const auto model = AveragedEmg::Build(muscles, speeds, {});
    return model ? "" : model.error().message;
  };
  EXPECT_EQ(message({}, SmallExample()), "no muscles, expected at least one");
  EXPECT_EQ(message({"m"}, {}), "no speeds, expected at least one");
  EXPECT_EQ(message({"m", "n"}, SmallExample()), "1 muscles at 115 deg/s, expected 2");
  auto speeds = SmallExample();
  speeds[0].speed = NAN;
  EXPECT_EQ(message({"m"}, speeds), "speed nan: expected a finite number");
  speeds = SmallExample();
  speeds[1].speed = 2;
  EXPECT_EQ(message({"m"}, speeds), "115 deg/s comes twice, expected its cycles together");
  speeds = SmallExample();
  speeds[1].muscles[0][1].pop_back();
  EXPECT_EQ(message({"m"}, speeds), "m at 57.3 deg/s: a cycle of 2 samples, expected 3");
  speeds = SmallExample();
  speeds[1].muscles[0][1][2] = NAN;
  EXPECT_EQ(message({"m"}, speeds), "m at 57.3 deg/s: sample 2 of a cycle is nan, expected a finite number");
  EXPECT_THAT(message({"m"}, {{1, {{{0, 0}, {0, 0}}}}}), HasSubstr("no muscle has a shape: m: no speed has"));
  AveragedEmgSettings settings;
  settings.fewest_cycles = 0;
  EXPECT_FALSE(AveragedEmg::Build({"m"}, SmallExample(), settings));
}

}  // namespace
}  // namespace sinew
