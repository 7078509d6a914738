// Soles that are proposed for the stepping robot, which knows its own: a box of 160 x 90 mm, centred 20 mm in
// front of the ankle, 45.19 mm below it, pressed in by 4.2 to 4.8 mm.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <functional>

#include "problems/contact/soles/sole_proposal.h"
#include "tests/problems/support/stepping_data.h"

namespace sinew {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr double kSole = -0.04519;  // [m] of the bottom below the ankle
constexpr double kPressed = 0.0055;
constexpr double kHeel = -0.06;
constexpr double kTip = 0.10;

// The exact stances with a centre of pressure and a free moment: train_1 right, train_2 left, validate_1
// right.
Dataset WithCop() {
  Dataset data = ExactData();
  const auto problem = MakeContact(data, SettingsText(data)).value();
  const Prediction prediction = PredictEverything(*problem, TruthOf(*problem));
  for (std::size_t b = 0; b < problem->layout().size(); ++b) {
    const Block& block = problem->layout()[b];
    Grid& grid = data.trials.at(block.trial).grids.at("forces");
    if (grid.channels.count(block.channel) > 0) continue;
    EXPECT_EQ(block.prediction_time.size(), grid.time.size());
    const auto values = prediction.values(static_cast<int>(b));
    Channel& channel = grid.channels[block.channel];
    channel.unit = block.unit;
    channel.values.assign(values.data(), values.data() + values.size());
  }
  return data;
}

const Dataset& Steps() {
  static const Dataset kData = WithCop();
  return kData;
}

SoleProposal Propose(const Dataset& data, double floor_height = 0) {
  auto proposal = ProposeSoles(data, "model.osim", floor_height);
  EXPECT_TRUE(proposal) << (proposal ? "" : proposal.error().message);
  return proposal ? std::move(*proposal) : SoleProposal{};
}

void ForChannel(Dataset& data, const std::string& channel, const std::function<double(double)>& change) {
  for (auto& [trial_name, trial] : data.trials) {
    for (auto& [grid_name, grid] : trial.grids) {
      const auto found = grid.channels.find(channel);
      if (found == grid.channels.end()) continue;
      for (double& value : found->second.values) value = change(value);
    }
  }
}

// Every vector NAME_x, NAME_z of a kind ("cop", "force" of plates; the markers).
void ForHorizontal(Dataset& data, const std::function<bool(const std::string&)>& which,
                   const std::function<void(double time, double& x, double& z)>& change) {
  for (auto& [trial_name, trial] : data.trials) {
    for (auto& [grid_name, grid] : trial.grids) {
      for (auto& [name, channel] : grid.channels) {
        if (name.size() < 3 || name.substr(name.size() - 2) != "_x") continue;
        const std::string stem = name.substr(0, name.size() - 2);
        const auto z = grid.channels.find(stem + "_z");
        if (z == grid.channels.end() || !which(stem)) continue;
        for (std::size_t i = 0; i < grid.time.size(); ++i)
          change(grid.time[i], channel.values[i], z->second.values[i]);
      }
    }
  }
}

bool IsPlace(const std::string& stem) {
  return stem.find("_force") == std::string::npos;
}
bool IsCop(const std::string& stem) {
  return stem.find("_cop") != std::string::npos;
}

double BackOf(const ProposedRegion& r) {
  return r.position.x() - 0.5 * r.size.x();
}
double FrontOf(const ProposedRegion& r) {
  return r.position.x() + 0.5 * r.size.x();
}

// What a test of a fault says: of every record of the plate right.
std::vector<std::string> Faults(const SoleProposal& proposal) {
  std::vector<std::string> faults;
  for (const PlateFinding& finding : proposal.findings)
    faults.push_back(finding.trial + " " + finding.plate + " " + ToString(finding.found.fault));
  return faults;
}

std::vector<std::string> Bodies(const SoleProposal& proposal) {
  std::vector<std::string> bodies;
  for (const ProposedRegion& region : proposal.regions) bodies.push_back(region.body);
  return bodies;
}

void ExpectTheRobotsSoles(const SoleProposal& proposal, double end_tolerance, double width_tolerance) {
  ASSERT_EQ(proposal.regions.size(), 6U);
  for (const ProposedRegion& region : proposal.regions) {
    EXPECT_LT(region.orientation.cwiseAbs().maxCoeff(), 0.02) << region.name;
    EXPECT_GT(region.position.y(), kSole) << region.name;
    EXPECT_LT(region.position.y(), kSole + kPressed) << region.name;
    if (region.patch > 0) {
      EXPECT_NEAR(region.position.z(), 0, 0.01) << region.name;
      EXPECT_NEAR(region.size.z(), 0.09, width_tolerance) << region.name;
    }
  }
  for (const std::size_t foot : {0U, 3U}) {
    EXPECT_NEAR(BackOf(proposal.regions[foot]), kHeel, end_tolerance);
    EXPECT_NEAR(FrontOf(proposal.regions[foot]), BackOf(proposal.regions[foot + 1]), 2e-4);
    EXPECT_NEAR(FrontOf(proposal.regions[foot + 1]), BackOf(proposal.regions[foot + 2]), 2e-4);
    EXPECT_NEAR(FrontOf(proposal.regions[foot + 2]), kTip, end_tolerance);
  }
}

TEST(Soles, OfTheRobotAreWhereTheyAre) {
  const SoleProposal proposal = Propose(Steps());
  EXPECT_THAT(Faults(proposal), IsEmpty());
  ExpectTheRobotsSoles(proposal, 0.015, 0.025);
  ASSERT_EQ(proposal.regions.size(), 6U);
  EXPECT_THAT(Bodies(proposal),
              ElementsAre("calcn_r", "calcn_r", "calcn_r", "calcn_l", "calcn_l", "calcn_l"));
  EXPECT_EQ(proposal.regions[0].plate, "right");
  EXPECT_EQ(proposal.regions[3].plate, "left");
  EXPECT_THAT(proposal.fit, ElementsAre("force_x", "force_y", "force_z", "cop_x", "cop_z", "moment_y"));
  EXPECT_THAT(proposal.findings, IsEmpty());
  EXPECT_THAT(proposal.skipped, IsEmpty());
  EXPECT_EQ(proposal.belt.x, 0);
  EXPECT_EQ(proposal.belt.z, 0);
  EXPECT_GT(proposal.stiffness_start, 0.1 * kTruth.at("stiffness"));
  EXPECT_LT(proposal.stiffness_start, 10 * kTruth.at("stiffness"));
}

TEST(Soles, BothFeetGetTheMeanOfBoth) {
  const SoleProposal proposal = Propose(Steps());
  ASSERT_EQ(proposal.regions.size(), 6U);
  for (std::size_t p = 0; p < 3; ++p) {
    const ProposedRegion& right = proposal.regions[p];
    const ProposedRegion& left = proposal.regions[p + 3];
    EXPECT_EQ(proposal.feet[right.foot].source, SoleSource::kBoth);
    EXPECT_LT((right.position - Vec3(left.position.x(), left.position.y(), -left.position.z())).norm(), 2e-4);
    EXPECT_LT(
        (right.orientation + Vec3(left.orientation.x(), left.orientation.y(), -left.orientation.z())).norm(),
        2e-4);
    EXPECT_EQ(right.size, left.size);
  }
}

TEST(Soles, FeetThatLieDifferentlyKeepTheirOwnPlanes) {
  Dataset data = Steps();
  constexpr double kTurned =
      0.3;  // [rad] of the right foot in the model, as by markers that were placed wrongly
  ForChannel(data, "subtalar_angle_r", [](double angle) { return angle + kTurned; });
  const SoleProposal proposal = Propose(data);
  ASSERT_EQ(proposal.feet.size(), 2U);
  EXPECT_EQ(proposal.feet[0].source, SoleSource::kOwn);
  EXPECT_EQ(proposal.feet[1].source, SoleSource::kOwn);
  EXPECT_NEAR(proposal.feet[0].differs_angle, kTurned, 0.03);
  ASSERT_EQ(proposal.regions.size(), 6U);
  EXPECT_NEAR(std::abs(proposal.regions[0].orientation.x()), kTurned, 0.03);
  EXPECT_NEAR(proposal.regions[3].orientation.x(), 0, 0.02);
}

TEST(Soles, AFootThatIsHeldOutMirrorsTheOther) {
  Dataset data = Steps();
  data.trials.at("train_2").role = Role::kValidate;
  const SoleProposal proposal = Propose(data);
  ExpectTheRobotsSoles(proposal, 0.015, 0.025);
  ASSERT_EQ(proposal.feet.size(), 2U);
  EXPECT_EQ(proposal.feet[0].source, SoleSource::kOwn);
  EXPECT_EQ(proposal.feet[1].source, SoleSource::kOther);
  EXPECT_THAT(proposal.feet[1].estimate.trials, ElementsAre("train_1"));
  // Its own data say nothing about the geometry.
  for (double& value : data.trials.at("train_2").grids.at("forces").channels.at("left_cop_z").values)
    value += 0.02;
  const SoleProposal again = Propose(data);
  ASSERT_EQ(again.regions.size(), 6U);
  for (std::size_t r = 0; r < 6; ++r) EXPECT_EQ(again.regions[r].position, proposal.regions[r].position);
}

TEST(Soles, AreFoundWithoutACentreOfPressure) {
  const SoleProposal proposal = Propose(ExactData());
  ExpectTheRobotsSoles(proposal, 0.015, 0.025);
  EXPECT_THAT(proposal.fit, ElementsAre("force_x", "force_y", "force_z"));
  EXPECT_THAT(proposal.not_fit, ElementsAre("cop_x", "cop_z", "moment_y"));
}

TEST(Soles, AreFoundWithoutMarkersOfTheFeet) {
  Dataset data = Steps();
  for (auto& [name, trial] : data.trials) trial.grids.erase("markers");
  const SoleProposal proposal = Propose(data);
  // The centre of pressure of a rigid sole does not reach its ends.
  ExpectTheRobotsSoles(proposal, 0.035, 0.04);
  EXPECT_FALSE(proposal.belt.by_markers);
}

TEST(Soles, NamesPlayNoPart) {
  Dataset data = Steps();
  std::string& osim = data.files.at("model.osim");
  const auto rename = [&](const std::string& from, const std::string& to) {
    for (auto at = osim.find(from); at != std::string::npos; at = osim.find(from, at + to.size()))
      osim.replace(at, from.size(), to);
  };
  rename("calcn_r", "segment9");
  rename("calcn_l", "segment4");
  rename("RHEE", "M17");
  for (auto& [name, trial] : data.trials) {
    auto& channels = trial.grids.at("markers").channels;
    for (const char* axis : {"_x", "_y", "_z"})
      channels[std::string("M17") + axis] = channels.at(std::string("RHEE") + axis);
  }
  const SoleProposal proposal = Propose(data);
  const SoleProposal before = Propose(Steps());
  ASSERT_EQ(proposal.regions.size(), 6U);
  EXPECT_THAT(Bodies(proposal),
              ElementsAre("segment9", "segment9", "segment9", "segment4", "segment4", "segment4"));
  for (std::size_t r = 0; r < 6; ++r) EXPECT_EQ(proposal.regions[r].position, before.regions[r].position);
}

// The whole laboratory turned about the vertical.
Dataset Turned(double angle) {
  Dataset data = Steps();
  const double c = std::cos(angle);
  const double s = std::sin(angle);
  ForHorizontal(
      data, [](const std::string& stem) { return stem != "pelvis_t"; },
      [&](double, double& x, double& z) {
        const double turned = c * x + s * z;
        z = -s * x + c * z;
        x = turned;
      });
  const Mat3 turn = Eigen::AngleAxisd(angle, Vec3::UnitY()).toRotationMatrix();
  for (auto& [name, trial] : data.trials) {
    auto& channels = trial.grids.at("coordinates").channels;
    const auto at = [&](const char* coordinate, std::size_t i) -> double& {
      return channels.at(coordinate).values[i];
    };
    for (std::size_t i = 0; i < trial.grids.at("coordinates").time.size(); ++i) {
      const Mat3 pelvis = turn * Eigen::AngleAxisd(at("pelvis_tilt", i), Vec3::UnitZ()).toRotationMatrix() *
                          Eigen::AngleAxisd(at("pelvis_list", i), Vec3::UnitX()).toRotationMatrix();
      at("pelvis_tilt", i) = std::atan2(-pelvis(0, 1), pelvis(1, 1));
      at("pelvis_list", i) = std::asin(pelvis(2, 1));
      at("pelvis_rotation", i) = std::atan2(-pelvis(2, 0), pelvis(2, 2));
      const Vec3 place = turn * Vec3(at("pelvis_tx", i), 0, at("pelvis_tz", i));
      at("pelvis_tx", i) = place.x();
      at("pelvis_tz", i) = place.z();
    }
  }
  return data;
}

TEST(Soles, WalkingMayGoAnyWay) {
  const SoleProposal before = Propose(Steps());
  for (const double angle : {0.9, -1.5707963, 3.0}) {
    const SoleProposal proposal = Propose(Turned(angle));
    EXPECT_THAT(Faults(proposal), IsEmpty()) << angle;
    ASSERT_EQ(proposal.regions.size(), before.regions.size()) << angle;
    for (std::size_t r = 0; r < 6; ++r) {
      EXPECT_LT((proposal.regions[r].position - before.regions[r].position).norm(), 5e-4) << angle;
      EXPECT_LT((proposal.regions[r].orientation - before.regions[r].orientation).norm(), 5e-4) << angle;
    }
  }
}

TEST(Soles, ABeltIsSeen) {
  Dataset data = Steps();
  const auto belt = [](double time, double& x, double& z) {
    x -= 0.8 * time;
    z += 0.3 * time;
  };
  ForHorizontal(data, IsPlace, belt);  // markers, centre of pressure and the pelvis' coordinates tx, tz
  for (auto& [name, trial] : data.trials) {
    Grid& grid = trial.grids.at("coordinates");
    for (std::size_t i = 0; i < grid.time.size(); ++i)
      belt(grid.time[i], grid.channels.at("pelvis_tx").values[i], grid.channels.at("pelvis_tz").values[i]);
  }
  const SoleProposal proposal = Propose(data);
  EXPECT_NEAR(proposal.belt.x, -0.8, 0.03);
  EXPECT_NEAR(proposal.belt.z, 0.3, 0.03);
  EXPECT_TRUE(proposal.belt.by_markers);
  ExpectTheRobotsSoles(proposal, 0.015, 0.025);
}

TEST(Soles, TheFloorsHeightIsStated) {
  Dataset data = Steps();
  ForChannel(data, "pelvis_ty", [](double y) { return y + 0.1; });
  ExpectTheRobotsSoles(Propose(data, 0.1), 0.015, 0.025);
}

TEST(Soles, AFootOnSeveralPlatesHasRegionsForEach) {
  Dataset data = Steps();
  auto& channels = data.trials.at("validate_1").grids.at("forces").channels;
  for (const std::string& kind : kContactChannels) {
    channels["fp3_" + kind] = channels.at("right_" + kind);
    channels.erase("right_" + kind);
  }
  const SoleProposal proposal = Propose(data);
  std::vector<std::string> names;
  for (const ProposedRegion& region : proposal.regions) names.push_back(region.name);
  ASSERT_THAT(names, ElementsAre("calcn_r_rearfoot_fp3", "calcn_r_forefoot_fp3", "calcn_r_toes_fp3",
                                 "calcn_r_rearfoot_right", "calcn_r_forefoot_right", "calcn_r_toes_right",
                                 "calcn_l_rearfoot", "calcn_l_forefoot", "calcn_l_toes"));
  EXPECT_EQ(proposal.regions[0].position, proposal.regions[3].position);
}

TEST(Soles, OneFootAloneIsEnough) {
  Dataset data = Steps();
  data.trials.erase("train_2");
  const SoleProposal proposal = Propose(data);
  EXPECT_THAT(Bodies(proposal),
              ElementsAre("calcn_r", "calcn_r", "calcn_r", "calcn_l", "calcn_l", "calcn_l"));
  ASSERT_EQ(proposal.feet.size(), 2U);
  EXPECT_EQ(proposal.feet[0].source, SoleSource::kOwn);
  // The other one is its mirror image, under the name of its body.
  EXPECT_EQ(proposal.feet[1].source, SoleSource::kNoPlate);
  EXPECT_EQ(proposal.regions[3].plate, "calcn_l");
  const Vec3& right = proposal.regions[0].position;
  EXPECT_LT((proposal.regions[3].position - Vec3(right.x(), right.y(), -right.z())).norm(), 1e-9);
}

TEST(Soles, PlatesThatAreWrongAreNamed) {
  const auto faults_after = [](const std::function<void(Dataset&)>& damage) {
    Dataset data = Steps();
    damage(data);
    return Faults(Propose(data));
  };
  const auto right_is = [](const std::string& fault) {
    return ElementsAre("train_1 right " + fault, "validate_1 right " + fault);
  };
  EXPECT_THAT(
      faults_after([](Dataset& data) { ForChannel(data, "right_force_y", [](double f) { return -f; }); }),
      right_is("upside_down"));
  EXPECT_THAT(faults_after([](Dataset& data) {
                ForChannel(data, "right_force_y", [](double f) { return 1e-3 * f; });
              }),
              right_is("not_loaded"));
  EXPECT_THAT(faults_after([](Dataset& data) {
                ForHorizontal(
                    data, [](const std::string& stem) { return stem == "right_cop"; },
                    [](double, double& x, double& z) {
                      x += 3;
                      z += 1;
                    });
              }),
              right_is("no_foot"));
  EXPECT_THAT(faults_after([](Dataset& data) {
                ForHorizontal(
                    data, [](const std::string& stem) { return stem == "right_force"; },
                    [](double, double& x, double& z) { std::swap(x, z); });
              }),
              right_is("force_across"));
  EXPECT_THAT(faults_after([](Dataset& data) {
                ForHorizontal(
                    data, [](const std::string& stem) { return stem == "right_force"; },
                    [](double, double& x, double& z) {
                      x = -x;
                      z = -z;
                    });
              }),
              right_is("force_reversed"));
}

TEST(Soles, APartOfAStanceSaysNothing) {
  Dataset data = Steps();
  Trial part = data.trials.at("train_1");
  for (auto& [name, channel] : part.grids.at("forces").channels)
    channel.values.resize(channel.values.size() / 2);
  Grid& forces = part.grids.at("forces");
  forces.time.resize(forces.time.size() / 2);
  data.trials["cut_off"] = part;
  const SoleProposal proposal = Propose(data);
  EXPECT_THAT(Faults(proposal), ElementsAre("cut_off right partial"));
  const SoleProposal before = Propose(Steps());
  ASSERT_EQ(proposal.regions.size(), 6U);
  for (std::size_t r = 0; r < 6; ++r) EXPECT_EQ(proposal.regions[r].position, before.regions[r].position);
}

// Far from the origin, where axes that are exchanged move the centre of pressure away.
Dataset Afar() {
  Dataset data = Steps();
  ForHorizontal(
      data, [](const std::string& stem) { return IsPlace(stem); },
      [](double, double& x, double&) { x += 2; });
  for (auto& [name, trial] : data.trials) {
    for (double& x : trial.grids.at("coordinates").channels.at("pelvis_tx").values) x += 2;
  }
  return data;
}

TEST(Soles, ACentreOfPressureWithOtherAxesOrUnitsIsNamed) {
  Dataset turned = Afar();
  ForHorizontal(turned, IsCop, [](double, double& x, double& z) {
    const double was = x;
    x = -z;
    z = was;
  });
  const SoleProposal of_turned = Propose(turned);
  EXPECT_THAT(of_turned.regions, IsEmpty());
  ASSERT_EQ(of_turned.findings.size(), 3U);
  EXPECT_EQ(of_turned.findings[0].found.fault, PlateFault::kTurned);
  EXPECT_EQ(of_turned.findings[0].found.axes, "z, -x");

  Dataset large = Afar();
  ForHorizontal(large, IsCop, [](double, double& x, double& z) {
    x *= 1000;
    z *= 1000;
  });
  const SoleProposal of_large = Propose(large);
  ASSERT_EQ(of_large.findings.size(), 3U);
  EXPECT_EQ(of_large.findings[0].found.fault, PlateFault::kMillimetres);
}

TEST(Soles, ACentreOfPressureAcrossTheFootIsNamed) {
  Dataset data = Steps();
  // Turned about the middle of its own path, as by a plate whose axes are exchanged about its centre.
  for (const char* name : {"train_1", "validate_1"}) {
    auto& channels = data.trials.at(name).grids.at("forces").channels;
    auto& x = channels.at("right_cop_x").values;
    auto& z = channels.at("right_cop_z").values;
    const double middle_x = 0.5 * (x.front() + x.back());
    const double middle_z = 0.5 * (z.front() + z.back());
    for (std::size_t i = 0; i < x.size(); ++i) {
      const double dx = x[i] - middle_x;
      x[i] = middle_x + z[i] - middle_z;
      z[i] = middle_z - dx;
    }
  }
  EXPECT_THAT(Faults(Propose(data)), ElementsAre("train_1 right cop_across", "validate_1 right cop_across"));
}

TEST(Soles, TwoFeetOnOnePlateAreNamed) {
  Dataset data = Steps();
  // In the second half the centre of pressure goes over to the foot of the other step.
  Grid& grid = data.trials.at("train_1").grids.at("forces");
  const double other = 0.1;  // [m] between the feet
  for (std::size_t i = grid.time.size() / 2; i < grid.time.size(); ++i)
    grid.channels.at("right_cop_z").values[i] -= other;
  const SoleProposal proposal = Propose(data);
  ASSERT_EQ(proposal.findings.size(), 1U);
  EXPECT_EQ(proposal.findings[0].found.fault, PlateFault::kTwoFeet);
  EXPECT_EQ(proposal.findings[0].trial, "train_1");
  EXPECT_EQ(proposal.findings[0].other_body, "calcn_l");
}

TEST(Soles, WhatCannotBeProposedIsAnError) {
  const auto error_after = [](const std::function<void(Dataset&)>& damage) {
    Dataset data = Steps();
    damage(data);
    const auto proposal = ProposeSoles(data, "model.osim", 0);
    return proposal ? "" : proposal.error().message;
  };
  EXPECT_THAT(error_after([](Dataset& data) { data.files.erase("model.osim"); }),
              HasSubstr("holds no file 'model.osim'"));
  EXPECT_THAT(error_after([](Dataset& data) {
                for (auto& [name, trial] : data.trials) trial.grids.erase("coordinates");
              }),
              HasSubstr("run `sinew data kinematics`"));
  EXPECT_THAT(error_after([](Dataset& data) {
                for (auto& [name, trial] : data.trials) trial.grids.erase("forces");
              }),
              HasSubstr("no trial has a plate"));
  EXPECT_THAT(
      error_after([](Dataset& data) {
        auto& channels = data.trials.at("train_2").grids.at("forces").channels;
        for (const std::string& kind : kContactChannels) {
          channels["right_" + kind] = channels.at("left_" + kind);
          channels.erase("left_" + kind);
        }
      }),
      HasSubstr("plate 'right' carries 'calcn_r' in trial 'train_1' and 'calcn_l' in trial 'train_2'"));
}

}  // namespace
}  // namespace sinew
