// What a check of data finds, and what it must not find in clean data with structure.
#include "datasets/check/check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "datasets/check/mask.h"

namespace sinew {
namespace {

using Function = std::function<double(double)>;

std::vector<double> Clock(double duration_s, double rate_Hz) {
  std::vector<double> time;
  for (int i = 0; i <= static_cast<int>(duration_s * rate_Hz); ++i) time.push_back(i / rate_Hz);
  return time;
}

Channel Sampled(const std::vector<double>& time, const Function& signal, const std::string& unit,
                double noise = 0, int seed = 1, ChannelKind kind = ChannelKind::kMeasured) {
  std::mt19937 random(static_cast<unsigned>(seed));
  std::normal_distribution<double> normal;
  Channel channel;
  channel.unit = unit;
  channel.kind = kind;
  for (const double t : time) channel.values.push_back(signal(t) + noise * normal(random));
  return channel;
}

// Strides of 0.8 s whose length and size vary, with noise: joint moment, angle, vertical force.
Dataset Running(int strides = 74, int seed = 1) {
  std::mt19937 random(static_cast<unsigned>(seed));
  std::normal_distribution<double> normal;
  std::vector<double> starts{0};
  std::vector<double> sizes;
  for (int k = 0; k < strides; ++k) {
    starts.push_back(starts.back() + 0.8 * (1 + 0.02 * normal(random)));
    sizes.push_back(1 + 0.05 * normal(random));
  }
  const auto phase = [=](double t) {
    const auto k =
        static_cast<std::size_t>(std::upper_bound(starts.begin(), starts.end(), t) - starts.begin()) - 1;
    const std::size_t at = std::min(k, sizes.size() - 1);
    return std::pair{(t - starts[at]) / (starts[at + 1] - starts[at]), sizes[at]};
  };
  Dataset data;
  Trial trial;
  Grid grid;
  grid.time = Clock(starts.back() - 0.01, 200);
  grid.channels["ankle_moment"] = Sampled(
      grid.time,
      [&](double t) {
        const auto [p, size] = phase(t);
        return p < 0.35 ? -180 * size * std::sin(M_PI * p / 0.35)
                        : 3 * std::sin(2 * M_PI * (p - 0.35) / 0.65);
      },
      "N*m", 2);
  grid.channels["ankle_angle"] = Sampled(
      grid.time,
      [&](double t) {
        return 0.4 * std::sin(2 * M_PI * phase(t).first) + 0.1 * std::cos(4 * M_PI * phase(t).first);
      },
      "rad", 0.005, 2, ChannelKind::kInput);
  grid.channels["right_force_y"] = Sampled(
      grid.time,
      [&](double t) {
        const auto [p, size] = phase(t);
        return p < 0.35 ? 1700 * size * std::sin(M_PI * p / 0.35) : 0;
      },
      "N");
  trial.grids["motion"] = grid;
  data.trials["run"] = trial;
  return data;
}

std::vector<Finding> OfKind(const Dataset& data, FindingKind kind) {
  std::vector<Finding> found;
  for (const Finding& finding : CheckData(data).findings) {
    if (finding.kind == kind) found.push_back(finding);
  }
  return found;
}

std::vector<std::string> Kinds(const Dataset& data) {
  std::vector<std::string> kinds;
  for (const Finding& finding : CheckData(data).findings)
    kinds.push_back(std::string(ToString(finding.kind)) + " " + finding.channel + " " + finding.trial);
  return kinds;
}

std::vector<double>& Values(Dataset& data, const std::string& channel, const std::string& trial = "run") {
  return data.trials.at(trial).grids.begin()->second.channels.at(channel).values;
}

// One trial with one channel.
Dataset One(const std::vector<double>& time, const Channel& channel) {
  Dataset data;
  data.trials["run"].grids["sensor"].time = time;
  data.trials["run"].grids["sensor"].channels["x"] = channel;
  return data;
}

TEST(DataCheck, CleanRunningHasNoRemark) {
  for (int seed = 1; seed <= 10; ++seed) EXPECT_THAT(Kinds(Running(74, seed)), testing::IsEmpty()) << seed;
}

// Half of the squared error in 11 steps of 74, apart from each other: no single stretch shows it.
TEST(DataCheck, StepsSpoiltApartFromEachOtherAreFound) {
  Dataset data = Running();
  const auto& time = data.trials.at("run").grids.at("motion").time;
  std::vector<double>& moment = Values(data, "ankle_moment");
  std::vector<double> spoilt;
  for (const int step : {5, 11, 12, 20, 27, 33, 40, 46, 55, 61, 70}) {
    const double from = 0.8 * step + 0.1;
    spoilt.push_back(from);
    for (std::size_t i = 0; i < time.size(); ++i) {
      // Comes and goes smoothly, as inverse dynamics makes it.
      const double p = (time[i] - from) / 0.25;
      if (p > 0 && p < 1) moment[i] += 90 * std::sin(M_PI * p) * std::sin(M_PI * p);
    }
  }
  const auto found = OfKind(data, FindingKind::kOddCycle);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].channel, "ankle_moment");
  const auto touches = [](const TimeSpan& s, double from) { return s.from < from + 0.25 && s.to > from; };
  int hits = 0;
  for (const double from : spoilt) {
    hits += std::any_of(found[0].spans.begin(), found[0].spans.end(),
                        [&](const TimeSpan& s) { return touches(s, from); });
  }
  // Where the fault has the shape of the stance it only looks like a smaller step.
  EXPECT_GE(hits, 9);
  for (const TimeSpan& s : found[0].spans) {
    EXPECT_TRUE(std::any_of(spoilt.begin(), spoilt.end(), [&](double from) { return touches(s, from); }))
        << s.from;
  }
}

TEST(DataCheck, DropoutsAndSpikesAreFoundWhereTheyAre) {
  Dataset data = Running();
  std::vector<double>& force = Values(data, "right_force_y");
  const auto& time = data.trials.at("run").grids.at("motion").time;
  const auto peak =
      static_cast<std::size_t>(std::max_element(force.begin() + 4000, force.begin() + 4160) - force.begin());
  for (std::size_t i = peak - 3; i < peak + 3; ++i) force[i] = 0;
  Values(data, "ankle_angle")[7000] += 4;
  const auto dropouts = OfKind(data, FindingKind::kDropout);
  ASSERT_EQ(dropouts.size(), 1U);
  EXPECT_EQ(dropouts[0].channel, "right_force_y");
  EXPECT_NEAR(dropouts[0].spans[0].from, time[peak - 3], 1e-9);
  EXPECT_NEAR(dropouts[0].spans[0].to, time[peak + 2], 1e-9);
  const auto spikes = OfKind(data, FindingKind::kSpike);
  ASSERT_EQ(spikes.size(), 1U);
  EXPECT_EQ(spikes[0].channel, "ankle_angle");
  EXPECT_NEAR(spikes[0].size, 4, 0.1);
}

// A controller that differentiates an error answers its first one with a kick; of a sensor that is a fault.
TEST(DataCheck, AnInputMayJumpWhenItsControllerIsSwitchedOn) {
  const auto time = Clock(20, 100);
  for (const ChannelKind kind : {ChannelKind::kInput, ChannelKind::kMeasured}) {
    for (const std::size_t at : {1UL, 500UL}) {
      Channel torque = Sampled(
          time, [](double t) { return std::sin(3 * t) + 0.4 * std::sin(7.1 * t); }, "N*m", 0.002);
      torque.kind = kind;
      torque.values[at] += 4;
      const bool command = kind == ChannelKind::kInput && at == 1;
      EXPECT_EQ(OfKind(One(time, torque), FindingKind::kSpike).size(), command ? 0U : 1U) << at;
    }
  }
}

TEST(DataCheck, AStuckSensorIsFoundAlsoIfItRounds) {
  const auto time = Clock(20, 100);
  const auto motion = [](double t) { return std::sin(3 * t) + 0.4 * std::sin(7.1 * t); };
  for (const bool rounded : {false, true}) {
    Channel channel = Sampled(time, motion, "rad", rounded ? 0 : 0.002);
    for (double& v : channel.values) v = rounded ? std::round(v * 652) / 652 : v;
    EXPECT_THAT(Kinds(One(time, channel)), testing::IsEmpty());
    for (std::size_t i = 800; i < 830; ++i) channel.values[i] = channel.values[800];
    const auto found = OfKind(One(time, channel), FindingKind::kStuck);
    ASSERT_EQ(found.size(), 1U) << rounded;
    EXPECT_NEAR(found[0].spans[0].from, 8, 0.011);
    EXPECT_NEAR(found[0].spans[0].to, 8.29, 0.011);
  }
}

TEST(DataCheck, ClippingIsFoundAtItsLevel) {
  Dataset data = Running();
  for (double& v : Values(data, "ankle_moment")) v = std::max(v, -150.0);
  const auto found = OfKind(data, FindingKind::kClipping);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].size, -150);
  EXPECT_GT(found[0].spans.size(), 60U);
}

TEST(DataCheck, ADriftOfTheLevelAtRestIsFound) {
  Dataset data = Running();
  std::vector<double>& force = Values(data, "right_force_y");
  for (std::size_t i = 0; i < force.size(); ++i)
    force[i] += 120.0 * static_cast<double>(i) / static_cast<double>(force.size());
  const auto found = OfKind(data, FindingKind::kDrift);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].channel, "right_force_y");
  EXPECT_NEAR(found[0].size, 120, 10);
  EXPECT_TRUE(SuggestMask(data, found).empty()) << "a drift can be subtracted or fitted";
}

TEST(DataCheck, ADriftOfALongRecordOfAPlateIsFoundFromAllOfIt) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> between(3, 9);
  std::vector<double> steps{between(random)};
  while (steps.back() < 1500) steps.push_back(steps.back() + between(random));
  const auto force = [&](double drift) {
    return [=](double t) {
      const double since = t - *std::prev(std::upper_bound(steps.begin() + 1, steps.end(), t));
      return drift * t / 1500 + (since > 0 && since < 0.6 ? 700 : 0);
    };
  };
  const auto time = Clock(1490, 20);  // 5,000 levels of a quarter of a second
  for (const double drift : {0.0, 60.0}) {
    Dataset data = One(time, Sampled(time, force(drift), "N", 1));
    auto& channels = data.trials.begin()->second.grids.begin()->second.channels;
    channels["plate_force_y"] = channels.at("x");
    channels.erase("x");
    const auto found = OfKind(data, FindingKind::kDrift);
    ASSERT_EQ(found.size(), drift > 0 ? 1U : 0U);
    if (found.empty()) continue;
    EXPECT_NEAR(found[0].size, drift * 1490 / 1500, 1);
  }
}

TEST(DataCheck, AClockThatJumpsIsFound) {
  Dataset data = Running();
  auto& time = data.trials.at("run").grids.at("motion").time;
  for (std::size_t i = 3000; i < time.size(); ++i) time[i] += 0.3;
  const auto found = OfKind(data, FindingKind::kTimeJump);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NEAR(found[0].size, 0.305, 1e-6);
  EXPECT_NEAR(found[0].usual, 0.005, 1e-6);
}

// A pendulum with inertia, damping and stiffness, moved differently in each trial.
Dataset Bench() {
  Dataset data;
  for (int k = 0; k < 5; ++k) {
    const double w = 2 + 1.3 * k;
    const auto q = [=](double t) { return 0.5 * std::sin(w * t) + 0.2 * std::sin(2.3 * w * t + k); };
    const auto torque = [=](double t) {
      const double h = 1e-4;
      const double qd = (q(t + h) - q(t - h)) / (2 * h);
      const double qdd = (q(t + h) - 2 * q(t) + q(t - h)) / (h * h);
      return 0.1 * qdd + 0.4 * qd + 6 * q(t);
    };
    Trial trial;
    trial.role = k == 4 ? Role::kValidate : Role::kTrain;
    Grid& grid = trial.grids["joint"];
    grid.time = Clock(10, 100);
    grid.channels["position"] = Sampled(grid.time, q, "rad", 1e-3, k);
    grid.channels["torque"] = Sampled(grid.time, torque, "N*m", 0.02, 10 + k, ChannelKind::kInput);
    data.trials["sine_" + std::to_string(k)] = trial;
  }
  return data;
}

TEST(DataCheck, SignAndUnitOfOneTrialAreFoundByTheOthersAlsoIfItIsHeldOut) {
  EXPECT_THAT(Kinds(Bench()), testing::IsEmpty());
  for (const std::string trial : {"sine_1", "sine_4"}) {
    Dataset data = Bench();
    for (double& v : Values(data, "torque", trial)) v = -v;
    auto found = OfKind(data, FindingKind::kSign);
    ASSERT_EQ(found.size(), 1U) << trial;
    EXPECT_EQ(found[0].trial, trial);
    data = Bench();
    for (double& v : Values(data, "position", trial)) v *= 180 / M_PI;
    found = OfKind(data, FindingKind::kUnit);
    ASSERT_EQ(found.size(), 1U) << trial;
    EXPECT_EQ(found[0].trial, trial);
    EXPECT_EQ(found[0].channel, "position");
    EXPECT_NEAR(found[0].size, 57.3, 0.1);
  }
}

TEST(DataCheck, ATrialOutOfStepIsFound) {
  Dataset data = Bench();
  std::vector<double>& torque = Values(data, "torque", "sine_2");
  std::rotate(torque.begin(), torque.end() - 12, torque.end());
  const auto found = OfKind(data, FindingKind::kLag);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].trial, "sine_2");
  EXPECT_NEAR(std::abs(found[0].size), 0.12, 0.02);
}

TEST(DataCheck, ASpeedThatIsNotTheDerivativeOfItsPositionIsFound) {
  const auto make = [](double factor) {
    Dataset data = One(Clock(10, 200), {});
    Grid& grid = data.trials.at("run").grids.at("sensor");
    grid.channels.clear();
    grid.channels["position"] = Sampled(
        grid.time, [](double t) { return std::sin(2 * t) + 0.3 * std::sin(5 * t); }, "rad", 1e-4);
    grid.channels["speed"] = Sampled(
        grid.time, [=](double t) { return factor * (2 * std::cos(2 * t) + 1.5 * std::cos(5 * t)); }, "rad/s",
        1e-2, 3);
    return data;
  };
  EXPECT_THAT(Kinds(make(1)), testing::IsEmpty());
  EXPECT_THAT(Kinds(make(-1)), testing::ElementsAre("sign speed run"));
  EXPECT_THAT(Kinds(make(57.3)), testing::ElementsAre("unit speed run"));
}

// Structure of clean data that is none of a fault.
TEST(DataCheck, CleanSignalsWithStructureHaveNoRemark) {
  const auto time = Clock(20, 200);
  const auto sine = [](double t) {
    return std::sin(2 * t) + 0.5 * std::sin(5.3 * t + 1) + 0.2 * std::sin(11 * t);
  };
  const auto trapezoid = [](double t) {
    return std::clamp(std::abs(std::fmod(t, 4) - 2) * 2 - 1, -0.6, 0.6);
  };
  const auto held = [](double t) { return std::floor(t / 2.5) * 0.3 * (static_cast<int>(t) % 3); };
  const auto toss = [](double t) { return std::abs(1.5 * std::cos(1.1 * t)) * std::exp(-0.1 * t); };
  const auto contact = [](double t) { return std::max(0.0, 900 * std::sin(5 * t) - 100); };
  const auto envelope = [](double t) { return std::pow(std::max(0.0, std::sin(2.7 * t)), 3); };
  const auto input = ChannelKind::kInput;
  std::vector<std::pair<std::string, Channel>> clean{
      {"multisine", Sampled(time, sine, "N*m", 0, 1, input)},
      {"trapezoid", Sampled(time, trapezoid, "rad")},
      {"trapezoid with noise", Sampled(time, trapezoid, "rad", 1e-3)},
      {"held input", Sampled(time, held, "V", 0, 1, input)},
      {"constant", Sampled(
                       time, [](double) { return 0.7; }, "V", 0, 1, input)},
      {"toss", Sampled(time, toss, "m", 1e-3)},
      {"contact force", Sampled(time, contact, "N")},
      {"envelope", Sampled(time, envelope, "1")},
      {"saturated duty",
       Sampled(
           time, [&](double t) { return std::clamp(3 * sine(t), -1.0, 1.0); }, "1", 0, 1, input)}};
  Channel encoder = Sampled(time, sine, "rad");
  for (double& v : encoder.values) v = std::round(v * 4096 / (2 * M_PI)) * 2 * M_PI / 4096;
  clean.emplace_back("encoder", encoder);
  for (const int seed : {1, 2, 3, 4, 5}) {
    Channel emg = Sampled(
        time, [](double) { return 0.0; }, "V", 1e-4, seed);
    for (std::size_t i = 0; i < emg.values.size(); ++i) emg.values[i] *= 0.1 + envelope(time[i]);
    clean.emplace_back("raw EMG", emg);
    for (double& v : emg.values) v = std::abs(v);
    clean.emplace_back("rectified EMG", emg);
    clean.emplace_back("noise", Sampled(
                                    time, [](double) { return 0.0; }, "N", 1, seed));
  }
  for (const auto& [name, channel] : clean)
    EXPECT_THAT(Kinds(One(time, channel)), testing::IsEmpty()) << name;
}

TEST(DataCheck, AMaskMakesGapsAndIsRecorded) {
  Dataset data = Running();
  Values(data, "ankle_moment")[500] += 1000;
  Values(data, "ankle_angle")[7000] += 4;
  const auto mask = SuggestMask(data, CheckData(data).findings);
  const auto outcome = ApplyMask(data, mask);
  ASSERT_TRUE(outcome);
  EXPECT_TRUE(std::isnan(Values(data, "ankle_moment")[500]));
  // The angle is an input: what is measured at that time is left out instead.
  EXPECT_FALSE(std::isnan(Values(data, "ankle_angle")[7000]));
  EXPECT_TRUE(std::isnan(Values(data, "ankle_moment")[7000]));
  EXPECT_TRUE(std::isnan(Values(data, "right_force_y")[7000]));
  EXPECT_EQ(outcome->values, 3);
  const auto recorded = RecordedMask(data);
  ASSERT_TRUE(recorded);
  ASSERT_EQ(recorded->size(), mask.size());
  EXPECT_EQ(recorded->front().channel, mask.front().channel);
  EXPECT_EQ(recorded->front().span.from, mask.front().span.from);
  // The input is still wrong, but nothing is compared there.
  EXPECT_THAT(Kinds(data), testing::ElementsAre("spike ankle_angle run"));
  EXPECT_TRUE(data.Check());
}

TEST(DataCheck, AMaskThatLeavesNothingIsRefused) {
  Dataset data = Running();
  std::vector<MaskedSpan> mask;
  for (const char* channel : {"ankle_moment", "right_force_y"})
    mask.push_back({"run", "motion", channel, {0, 1000}, "unit"});
  const auto outcome = ApplyMask(data, mask);
  ASSERT_FALSE(outcome);
  EXPECT_EQ(outcome.error().message, "nothing measured would be left in any training trial");
  EXPECT_EQ(data.files.count(kMaskFile), 0U);
}

}  // namespace
}  // namespace sinew
