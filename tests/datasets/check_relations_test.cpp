// What a check of data finds by comparing channels: markers of a segment, plates and feet, devices, repeated
// inputs.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "datasets/check/check.h"
#include "datasets/check/mask.h"

namespace sinew {
namespace {

constexpr double kStride_s = 1.0;
constexpr double kSpeed_m_s = 1.2;
constexpr double kRate_Hz = 100;

std::vector<std::string> Found(const Dataset& data) {
  std::vector<std::string> found;
  for (const Finding& f : CheckData(data).findings)
    found.push_back(std::string(ToString(f.kind)) + " " + (f.channel.empty() ? "grid " + f.grid : f.channel));
  return found;
}

struct Point {
  double x, y, z;
};

// A foot that stands for 0.6 of its stride and swings for the rest, turning about its toes and in the air.
struct Foot {
  double phase = 0;  // [strides]

  [[nodiscard]] Point At(double t, double forward, double up, double side) const {
    const double cycle = t / kStride_s + phase;
    const double p = cycle - std::floor(cycle);
    const double swing = std::max(0.0, (p - 0.6) / 0.4);
    const double smooth = swing - std::sin(2 * M_PI * swing) / (2 * M_PI);
    const double x = kSpeed_m_s * kStride_s * (std::floor(cycle) + smooth);
    const double angle = -0.7 * std::sin(M_PI * swing) * (1 - 0.6 * swing);
    return {x + std::cos(angle) * forward - std::sin(angle) * up,
            0.08 * std::sin(M_PI * swing) + std::sin(angle) * forward + std::cos(angle) * up + 0.02, side};
  }
};

// Two feet, two shanks, and the forces on two plates; plate PLATE is loaded while its foot stands.
Dataset Walk(int seed = 1) {
  std::mt19937 random(static_cast<unsigned>(seed));
  std::normal_distribution<double> normal;
  Dataset data;
  Trial trial;
  Grid& markers = trial.grids["markers"];
  Grid& forces = trial.grids["forces"];
  for (int i = 0; i < 400; ++i) markers.time.push_back(i / kRate_Hz);
  for (int i = 0; i < 4000; ++i) forces.time.push_back(i / (10 * kRate_Hz));
  const std::vector<std::pair<std::string, Point>> places{{"Heel", {-0.05, 0.02, 0.0}},
                                                          {"Toe", {0.17, 0.03, 0.01}},
                                                          {"Mid", {0.08, 0.07, -0.02}},
                                                          {"Ankle", {0, 0.09, 0.03}}};
  for (const std::string side : {"R", "L"}) {
    const Foot foot{side == "R" ? 0.0 : 0.5};
    const double middle = side == "R" ? 0.1 : -0.1;
    const double out = side == "R" ? 1 : -1;
    for (const auto& [name, place] : places) {
      for (const char axis : {'x', 'y', 'z'}) {
        Channel channel;
        channel.unit = "m";
        channel.kind = ChannelKind::kInput;
        for (const double t : markers.time) {
          const Point p = foot.At(t, place.x, place.y, middle + out * place.z);
          channel.values.push_back((axis == 'x' ? p.x : axis == 'y' ? p.y : p.z) + 5e-4 * normal(random));
        }
        markers.channels[side + "." + name + "_" + axis] = channel;
      }
    }
    const std::string plate = side == "R" ? "right" : "left";
    for (const std::string name :
         {"force_x", "force_y", "force_z", "cop_x", "cop_y", "cop_z", "moment_x", "moment_y", "moment_z"}) {
      Channel channel;
      channel.unit = name[0] == 'f' ? "N" : name[0] == 'c' ? "m" : "N*m";
      for (const double t : forces.time) {
        const double cycle = t / kStride_s + foot.phase;
        const double p = cycle - std::floor(cycle);
        const bool loaded = p < 0.6;
        double value = 0;
        if (name == "force_y")
          value = loaded ? 700 * std::pow(std::sin(M_PI * p / 0.6), 0.4) *
                               (1 - 0.15 * std::sin(3 * M_PI * p / 0.6))
                         : 0;
        if (name == "force_x") value = loaded ? -110 * std::sin(2 * M_PI * p / 0.6) : 0;
        if (name == "force_z") value = loaded ? 30 * std::sin(M_PI * p / 0.6) : 0;
        if (name == "cop_x") value = loaded ? kSpeed_m_s * kStride_s * std::floor(cycle) + 0.2 * p / 0.6 : 0;
        if (name == "cop_z") value = loaded ? middle : 0;
        if (name[0] == 'f') value += 0.5 * normal(random);
        channel.values.push_back(value);
      }
      forces.channels[plate + "_" + name] = channel;
    }
  }
  data.trials["walk"] = trial;
  return data;
}

std::vector<double>& Marker(Dataset& data, const std::string& channel) {
  return data.trials.at("walk").grids.at("markers").channels.at(channel).values;
}

TEST(DataCheckSegments, ACleanWalkHasNoRemark) {
  for (int seed = 1; seed <= 3; ++seed) EXPECT_THAT(Found(Walk(seed)), testing::IsEmpty()) << seed;
}

TEST(DataCheckSegments, SignAxisUnitAndLagOfAMarkerAreTold) {
  Dataset data = Walk();
  for (double& v : Marker(data, "R.Heel_y")) v = -v;
  EXPECT_THAT(Found(data), testing::Contains("sign R.Heel_y"));
  data = Walk();
  std::swap(Marker(data, "L.Toe_x"), Marker(data, "L.Toe_y"));
  EXPECT_THAT(Found(data), testing::Contains("axis L.Toe_x"));
  data = Walk();
  for (double& v : Marker(data, "R.Mid_x")) v *= 1e-3;
  EXPECT_THAT(Found(data), testing::Contains("unit R.Mid_x"));
  data = Walk();
  for (const std::string axis : {"x", "y", "z"}) {
    std::vector<double>& values = Marker(data, "R.Ankle_" + axis);
    values.insert(values.begin(), 12, values.front());
    values.resize(400);
  }
  bool told = false;
  for (const Finding& f : CheckData(data).findings) {
    if (f.kind != FindingKind::kLag || f.channel != "R.Ankle_x") continue;
    told = true;
    EXPECT_NEAR(f.size, 0.12, 0.011);
  }
  EXPECT_TRUE(told);
}

// A coordinate that hardly moves: distances stay constant with the wrong sign, but are not those of the other
// side.
TEST(DataCheckSegments, TheSignOfASidewaysCoordinateIsToldByTheOtherSide) {
  Dataset data = Walk();
  for (double& v : Marker(data, "L.Toe_z")) v = -v;
  EXPECT_THAT(Found(data), testing::Contains("sign L.Toe_z"));
}

TEST(DataCheckSegments, AMarkerThatLeavesItsSegmentSmoothlyIsFoundAndMasked) {
  Dataset data = Walk();
  std::vector<double>& values = Marker(data, "R.Toe_x");
  for (std::size_t i = 150; i < 190; ++i)
    values[i] += 0.08 * std::pow(std::sin(M_PI * static_cast<double>(i - 150) / 40), 2);
  const auto findings = CheckData(data).findings;
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_EQ(findings[0].kind, FindingKind::kDisplaced);
  EXPECT_EQ(findings[0].channel, "R.Toe_x");
  EXPECT_NEAR(findings[0].spans.front().from, 1.58, 0.08);
  EXPECT_NEAR(findings[0].spans.back().to, 1.82, 0.08);
  // A marker is an input: what is measured at that time is left out.
  EXPECT_FALSE(SuggestMask(data, findings).empty());
}

TEST(DataCheckFeet, PlatesWithAnotherClockThanTheMarkersAreFound) {
  for (const double delay : {-0.15, 0.1, 0.2}) {
    Dataset data = Walk();
    for (double& t : data.trials.at("walk").grids.at("forces").time) t += delay;
    int told = 0;
    for (const Finding& f : CheckData(data).findings) {
      ASSERT_EQ(f.kind, FindingKind::kLag) << f.channel;
      EXPECT_NEAR(f.size, delay, 0.04);
      EXPECT_TRUE(f.undecided);
      ++told;
    }
    EXPECT_GE(told, 1) << delay;
  }
}

// Strides in two recordings at slightly different speeds: three devices with three channels each.
Dataset TwoRecordings() {
  Dataset data;
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  for (const auto& [name, period] : {std::pair{"slow", 1.15}, {"fast", 1.06}}) {
    Trial trial;
    for (const std::string device : {"emg", "angles", "moments"}) {
      Grid& grid = trial.grids[device];
      for (int i = 0; i < 3000; ++i) grid.time.push_back(i / 100.0);
      for (int c = 0; c < 3; ++c) {
        Channel channel;
        channel.unit = device == "emg" ? "1" : device == "angles" ? "rad" : "N*m";
        for (const double t : grid.time) {
          const double p = 2 * M_PI * t / period;
          const double shape = std::sin(p + c) +
                               0.5 * std::sin(2 * p + 2 * c + static_cast<double>(device.size())) +
                               0.2 * std::cos(3 * p);
          channel.values.push_back(device == "emg" ? std::max(0.0, shape) + 0.02 * std::abs(normal(random))
                                                   : shape + 0.02 * normal(random));
        }
        grid.channels[device + std::to_string(c)] = channel;
      }
    }
    data.trials[name] = trial;
  }
  return data;
}

TEST(DataCheckCycles, ADeviceThatIsLateInOneOfTwoRecordingsIsFoundAndNotMasked) {
  EXPECT_THAT(Found(TwoRecordings()), testing::IsEmpty());
  Dataset data = TwoRecordings();
  for (double& t : data.trials.at("slow").grids.at("emg").time) t += 0.15;
  const auto findings = CheckData(data).findings;
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_EQ(findings[0].kind, FindingKind::kLag);
  EXPECT_EQ(findings[0].grid, "emg");
  EXPECT_EQ(findings[0].channel, "");
  EXPECT_NEAR(std::abs(findings[0].size), 0.15, 0.02);
  EXPECT_TRUE(findings[0].undecided);
  EXPECT_TRUE(SuggestMask(data, findings).empty());
}

// The activity of a muscle doubles or halves from one stride to the next, with the same shape.
TEST(DataCheckCycles, SizesThatVaryAreNoFault) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  Dataset data;
  Grid& grid = data.trials["walk"].grids["emg"];
  Channel channel;
  Channel angle;
  channel.unit = "1";
  angle.unit = "rad";
  for (int k = 0; k < 40; ++k) {
    const double size = std::exp(0.5 * normal(random));
    for (int i = 0; i < 100; ++i) {
      const double p = i / 100.0;
      grid.time.push_back(0.01 * (100 * k + i));
      channel.values.push_back(size * std::pow(std::max(0.0, std::sin(2 * M_PI * p)), 2) +
                               0.02 * std::abs(normal(random)));
      angle.values.push_back(std::sin(2 * M_PI * p) + 0.01 * normal(random));
    }
  }
  grid.channels["vas_lat"] = channel;
  grid.channels["knee"] = angle;
  EXPECT_THAT(Found(data), testing::IsEmpty());
}

Dataset Repeated() {
  Dataset data;
  std::mt19937 random(2);
  std::normal_distribution<double> normal;
  for (int k = 0; k < 4; ++k) {
    Grid& grid = data.trials["size_" + std::to_string(k)].grids["motor"];
    Channel length;
    length.unit = "m";
    length.kind = ChannelKind::kInput;
    Channel force;
    force.unit = "N";
    for (int i = 0; i < 500; ++i) {
      const double t = i / 250.0;
      grid.time.push_back(t);
      length.values.push_back(0.03 + 1e-3 * (k + 1) * (std::sin(2.3 * t * t) + 0.4 * std::sin(9 * t)));
      force.values.push_back(1 + 0.1 * normal(random));
    }
    grid.channels["length"] = length;
    grid.channels["force"] = force;
  }
  return data;
}

TEST(DataCheckRepeats, AnInputThatRepeatsThatOfTheOtherTrialsIsComparedWithIt) {
  EXPECT_THAT(Found(Repeated()), testing::IsEmpty());
  Dataset data = Repeated();
  std::vector<double>& length = data.trials.at("size_1").grids.at("motor").channels.at("length").values;
  for (int i = 0; i < 40; ++i)
    length[static_cast<std::size_t>(200 + i)] += 1.5e-3 * std::pow(std::sin(M_PI * i / 40), 2);
  auto findings = CheckData(data).findings;
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_EQ(findings[0].kind, FindingKind::kDisplaced);
  EXPECT_EQ(findings[0].trial, "size_1");
  EXPECT_NEAR(findings[0].spans.front().from, 0.82, 0.04);
  data = Repeated();
  std::vector<double>& late = data.trials.at("size_2").grids.at("motor").channels.at("length").values;
  late.insert(late.begin(), 25, late.front());
  late.resize(500);
  findings = CheckData(data).findings;
  ASSERT_GE(findings.size(), 1U);
  bool told = false;
  for (const Finding& f : findings)
    told = told || (f.kind == FindingKind::kLag && f.trial == "size_2" && std::abs(f.size - 0.1) < 0.011);
  EXPECT_TRUE(told);
}

TEST(DataCheckRotations, AQuaternionWhoseNormIsNotOneIsFound) {
  Dataset data;
  for (int k = 0; k < 3; ++k) {
    Grid& grid = data.trials["toss_" + std::to_string(k)].grids["pose"];
    for (const char* part : {"_w", "_x", "_y", "_z"})
      grid.channels[std::string("orientation") + part].unit = "1";
    for (int i = 0; i < 100; ++i) {
      const double t = i / 100.0;
      const double half = 2 * t + k;
      grid.time.push_back(t);
      grid.channels["orientation_w"].values.push_back(std::cos(half));
      grid.channels["orientation_x"].values.push_back(0.6 * std::sin(half));
      grid.channels["orientation_y"].values.push_back(0.8 * std::sin(half));
      grid.channels["orientation_z"].values.push_back(0);
    }
  }
  EXPECT_THAT(Found(data), testing::IsEmpty());
  std::vector<double>& x = data.trials.at("toss_1").grids.at("pose").channels.at("orientation_x").values;
  for (std::size_t i = 30; i < 60; ++i) x[i] *= 0.3;
  EXPECT_THAT(Found(data), testing::Contains("inconsistent orientation_w"));
}

// EMG as an input: a lead that comes off repeats one value, which no command that is held does only once.
TEST(DataCheckStuck, AnInputThatIsStuckOnceIsFound) {
  Dataset data;
  Grid& grid = data.trials["run"].grids["emg"];
  Channel channel;
  channel.unit = "1";
  channel.kind = ChannelKind::kInput;
  std::mt19937 random(4);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 2000; ++i) {
    grid.time.push_back(i / 100.0);
    channel.values.push_back(0.5 + 0.4 * std::sin(0.05 * i) + 0.01 * normal(random));
  }
  for (std::size_t i = 800; i < 850; ++i) channel.values[i] = channel.values[800];
  grid.channels["soleus"] = channel;
  EXPECT_THAT(Found(data), testing::Contains("stuck soleus"));
}

}  // namespace
}  // namespace sinew
