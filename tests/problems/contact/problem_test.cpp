#include "problems/contact/problem.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "base/random.h"
#include "models/contact/simbody_contact.h"
#include "models/multibody/multibody_model.h"
#include "models/multibody/osim_reader.h"
#include "tests/problems/support/force_channels.h"
#include "tests/problems/support/jacobian_check.h"
#include "tests/problems/support/stepping_data.h"

namespace sinew {
namespace {

using testing::ElementsAre;

// Of the base parameters.
std::vector<std::string> Names(const std::vector<Parameter>& parameters) {
  std::vector<std::string> names;
  for (const Parameter& p : parameters) {
    if (p.kind == ParameterKind::kBase) names.push_back(p.name);
  }
  return names;
}

// Columns of a block that are base parameters.
std::vector<int> BaseColumns(const Problem& problem, int block) {
  std::vector<int> columns;
  for (const int column : problem.layout()[static_cast<std::size_t>(block)].columns) {
    if (problem.parameters()[static_cast<std::size_t>(column)].kind == ParameterKind::kBase)
      columns.push_back(column);
  }
  return columns;
}

TEST(ContactProblem, OneGroupHasPlainNamesAndSeveralArePrefixed) {
  const auto one = MakeContact(ExactData(), SettingsText(ExactData())).value();
  EXPECT_THAT(Names(one->parameters()), ElementsAre("stiffness", "dissipation", "static_friction",
                                                    "dynamic_friction", "viscous_friction"));
  EXPECT_EQ(Names(one->parameters()), Names(DefaultContactParameters()));
  const auto two = MakeContact(ExactData(), kHeelAndForefoot).value();
  ASSERT_EQ(Names(two->parameters()).size(), 10U);
  EXPECT_EQ(two->parameters()[0].name, "heel.stiffness");
  EXPECT_EQ(two->parameters()[9].name, "forefoot.viscous_friction");
}

TEST(ContactProblem, NormalForcesDoNotDependOnFriction) {
  const auto problem = MakeContact(ExactData(), SettingsText(ExactData(), kFitsVertical, kFitsForce)).value();
  const Prediction before = PredictEverything(*problem, TruthOf(*problem));
  Vector parameters = TruthOf(*problem);
  parameters.segment<3>(2) << 3, 7, 11;
  const Prediction after = PredictEverything(*problem, parameters);
  for (const Stance& stance : problem->data().stances) {
    for (const ForceChannel channel : {kFy, kCopX, kCopZ}) {
      const int block = stance.blocks[channel];
      EXPECT_THAT(BaseColumns(*problem, block), ElementsAre(0, 1));
      EXPECT_EQ(Vector(after.values(block)), Vector(before.values(block)));
    }
    for (const ForceChannel channel : {kFx, kFz, kPlateMomentY}) {
      EXPECT_GT((after.values(stance.blocks[channel]) - before.values(stance.blocks[channel])).norm(), 0);
    }
  }
}

TEST(ContactProblem, TwoGroupsOfEqualParametersAreOneSole) {
  constexpr double kRounding = 1e-12;  // the same faces, summed in two halves
  const auto one = MakeContact(ExactData(), SettingsText(ExactData())).value();
  const auto two = MakeContact(ExactData(), kHeelAndForefoot).value();
  const Prediction whole = PredictEverything(*one, TruthOf(*one));
  const Prediction halves = PredictEverything(*two, TruthOf(*two));
  ASSERT_EQ(one->layout().size(), two->layout().size());
  for (int b = 0; b < static_cast<int>(one->layout().size()); ++b) {
    const double size = whole.values(b).lpNorm<Eigen::Infinity>();
    EXPECT_LT((whole.values(b) - halves.values(b)).lpNorm<Eigen::Infinity>(), kRounding * size)
        << one->layout()[static_cast<std::size_t>(b)].channel;
    // A parameter of the whole moves both halves.
    const auto columns = static_cast<Eigen::Index>(BaseColumns(*one, b).size());
    const Matrix expected = whole.derivatives(b).leftCols(columns);
    const Matrix sum =
        halves.derivatives(b).leftCols(columns) + halves.derivatives(b).middleCols(columns, columns);
    EXPECT_LT((sum - expected).norm(), kRounding * (1 + expected.norm()));
  }
}

TEST(ContactProblem, JacobianOfTwoGroupsAgreesWithDifferences) {
  const auto problem = MakeContact(ExactData(), kHeelAndForefoot).value();
  Random random(1);
  ExpectJacobianAgrees(*problem, random, kSoleWithMemory);
}

// From the file of the model and the recorded coordinates to the channels of the plate, by another road.
TEST(ContactProblem, EveryChannelIsThatOfSimbodyOnTheSameStates) {
  constexpr double kTolerance = 1e-9;  // both sum some hundred faces; Simbody after more rotations
  const Dataset& data = ExactData();
  // Simbody has a spring on every face of the mesh.
  const std::string yaml = SettingsText(data, "plate: right\n", "plate: right\n      springs: all\n");
  const auto problem = MakeContact(data, yaml).value();
  const Stance& stance = problem->data().stances.front();
  const Prediction prediction = PredictEverything(*problem, TruthOf(*problem));

  const auto model =
      MultibodyModel::Build(ReadOsim(data.files.at("model.osim"), "model.osim").value()).value();
  const Grid& recorded = data.trials.at(stance.trial).grids.at("coordinates");
  const auto motion = RecordedMotion(model, recorded);
  const ContactRegionSettings& sole = problem->settings().regions.front();
  const int body = model.BodyIndex(sole.body).value();
  SimbodyContact simbody({sole.region}, {ContactProblem::Foundation(TruthOf(*problem), 0)},
                         problem->settings().transition_velocity, problem->settings().floor.height);

  double worst = 0;
  int pressing = 0;
  for (std::size_t i = 0; i < stance.time.size(); ++i) {
    const CoordinateState state = motion.At(stance.time[i]);
    const auto wrenches = simbody.WrenchesAt(model.BodyMotionAt(state.values, state.rates, {body}).value());
    ASSERT_TRUE(wrenches) << wrenches.error().message;
    const Vec3 force = wrenches->front().force;
    const Vec3 moment = wrenches->front().moment;
    const auto predicted = [&](ForceChannel channel) {
      return prediction.values(stance.blocks[channel])[static_cast<Eigen::Index>(i)];
    };
    if (force.y() == 0) {
      EXPECT_EQ(predicted(kFy), 0);
      continue;
    }
    ++pressing;
    const Vec3 found(predicted(kFx), predicted(kFy), predicted(kFz));
    worst = std::max(worst, (found - force).norm() / force.norm());
    const double cop_x = moment.z() / force.y();
    const double cop_z = -moment.x() / force.y();
    const double free_moment = moment.y() - (cop_z * force.x() - cop_x * force.z());
    worst = std::max({worst, std::abs(predicted(kCopX) - cop_x), std::abs(predicted(kCopZ) - cop_z),
                      std::abs(predicted(kPlateMomentY) - free_moment) / force.norm()});
  }
  std::printf("worst relative difference %.2e over %d instants\n", worst, pressing);
  EXPECT_GT(pressing, 20);
  EXPECT_LT(worst, kTolerance);
}

TEST(ContactProblem, WithoutPressureTheCentreOfPressureRestsAndNothingDependsOnAnything) {
  const std::string high = SettingsText(ExactData(), "floor_height: 0.0", "floor_height: -1.0");
  const auto problem = MakeContact(ExactData(), high).value();
  const Prediction prediction = PredictEverything(*problem, TruthOf(*problem));
  const Stance& stance = problem->data().stances.front();
  for (const ForceChannel channel : {kFx, kFy, kFz, kPlateMomentY}) {
    EXPECT_EQ(prediction.values(stance.blocks[channel]).norm(), 0);
    EXPECT_EQ(prediction.derivatives(stance.blocks[channel]).norm(), 0);
  }
  EXPECT_TRUE((prediction.values(stance.blocks[kCopX]).array() == stance.resting_cop[0]).all());
  EXPECT_TRUE((prediction.values(stance.blocks[kCopZ]).array() == stance.resting_cop[1]).all());
}

TEST(ContactProblem, DescribesPressuresThatCarryTheVerticalForce) {
  constexpr double kRounding = 1e-12;
  const auto problem = MakeContact(ExactData(), SettingsText(ExactData())).value();
  const Vector truth = TruthOf(*problem);
  Hdf5Node details;
  ASSERT_TRUE(problem->WriteDetails(truth, details));
  const Hdf5Node* sole = details.Find("contact/train_1/right_sole");
  ASSERT_NE(sole, nullptr);
  EXPECT_EQ(sole->Text("body"), "calcn_r");
  const Hdf5Array& pressure = *sole->Find("pressure")->array();
  const Hdf5Array& outline = *sole->Find("outline")->array();
  const std::size_t faces = outline.shape[0];
  ASSERT_THAT(outline.shape, ElementsAre(2U * 12 * 7, 3U, 2U));
  const double area = 0.16 * 0.09 / static_cast<double>(faces);
  const Stance& stance = problem->data().stances.front();
  const Prediction prediction = PredictEverything(*problem, truth);
  const auto force = prediction.values(stance.blocks[kFy]);
  ASSERT_THAT(pressure.shape, ElementsAre(stance.time.size(), faces));
  for (std::size_t t = 0; t < stance.time.size(); ++t) {
    double total = 0;
    for (std::size_t face = 0; face < faces; ++face) total += area * pressure.values[t * faces + face];
    EXPECT_NEAR(total, force[static_cast<Eigen::Index>(t)], kRounding * (1 + total));
  }
}

}  // namespace
}  // namespace sinew
