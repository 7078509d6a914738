// Each contact effect against a case where its answer is known by another road, its null and its derivative.
#include "problems/contact/effects.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "base/random.h"
#include "models/multibody/multibody_model.h"
#include "models/multibody/osim_reader.h"
#include "problems/contact/load/effect_load.h"
#include "tests/problems/support/force_channels.h"
#include "tests/problems/support/jacobian_check.h"
#include "tests/problems/support/stepping_data.h"

namespace sinew {
namespace {

using testing::Contains;

std::unique_ptr<ContactProblem> Exact(const std::string& what = "", const std::string& by = "") {
  return MakeContact(ExactData(), SettingsText(ExactData(), what, by)).value();
}

int IndexOf(const Problem& problem, const std::string& name) {
  return FindParameter(problem.parameters(), name).value();
}

Vector With(const Problem& problem, const std::map<std::string, double>& values) {
  Vector parameters = TruthOf(problem);
  for (const auto& [name, value] : values) parameters[IndexOf(problem, name)] = value;
  return parameters;
}

Vector Vertical(const ContactProblem& problem, const Vector& parameters, std::size_t stance = 0) {
  return PredictEverything(problem, parameters).values(problem.data().stances[stance].blocks[kFy]);
}

// A region at one instant whose body does not turn.
EffectRegion Level(ContactKinematics kinematics) {
  EffectRegion region;
  region.kinematics = std::move(kinematics);
  region.turning_x = region.turning_z = {0};
  return region;
}

// Largest difference of two predictions of the same layout, relative to the largest value of each block.
double Difference(const Problem& problem, const Prediction& a, const Prediction& b) {
  double worst = 0;
  for (int i = 0; i < static_cast<int>(problem.layout().size()); ++i) {
    const double size = std::max(1e-12, a.values(i).lpNorm<Eigen::Infinity>());
    worst = std::max(worst, (a.values(i) - b.values(i)).lpNorm<Eigen::Infinity>() / size);
  }
  return worst;
}

TEST(ContactEffects, PlatesHaveTheirOwnHeightOnlyIfThereAreTwo) {
  const auto names = [](const Problem& problem) {
    std::vector<std::string> found;
    for (const Effect& effect : problem.effects()) found.push_back(effect.name);
    return found;
  };
  const auto both = Exact();
  EXPECT_THAT(names(*both), Contains("right.height_offset"));
  EXPECT_THAT(names(*both), Contains("left.height_offset"));
  const auto one = Exact("plate: left", "plate: right").get()->effects();
  for (const Effect& effect : one) EXPECT_EQ(effect.name.find('.'), std::string::npos) << effect.name;
  EXPECT_EQ(one.size() + 2, both->effects().size());
}

// The plate's channels do not know whether the kinematics are too high or the floor too low.
TEST(ContactEffects, AHeightOffsetIsAHigherFloor) {
  constexpr double kTolerance = 1e-9;  // millimetres are differences of heights of decimetres
  const auto level = Exact();
  const auto raised = Exact("floor_height: 0.0", "floor_height: 0.0008");
  const Prediction expected = PredictEverything(*raised, TruthOf(*raised));
  EXPECT_LT(Difference(*level, expected, PredictEverything(*level, With(*level, {{"height_offset", 8e-4}}))),
            kTolerance);
  // Both plates at once, each by its own.
  const Vector own = With(*level, {{"right.height_offset", 8e-4}, {"left.height_offset", 8e-4}});
  EXPECT_LT(Difference(*level, expected, PredictEverything(*level, own)), kTolerance);
  // And one of them alone.
  const Vector right = With(*level, {{"right.height_offset", 8e-4}});
  for (std::size_t s = 0; s < level->data().stances.size(); ++s) {
    const bool moves = level->data().stances[s].plate == "right";
    EXPECT_EQ(Vertical(*level, right, s) == Vertical(*level, TruthOf(*level), s), !moves);
  }
}

// Effects at their null change nothing, whether their derivatives are asked for or not; and the path with
// effects tends to the one without.
TEST(ContactEffects, AtTheirNullTheyChangeNothing) {
  constexpr double kRounding = 1e-11;
  const auto problem = Exact(kFitsVertical, kFitsForce);
  const Vector truth = TruthOf(*problem);
  const Prediction all = PredictEverything(*problem, truth);

  std::vector<bool> base(problem->parameters().size(), false);
  std::fill_n(base.begin(), 5, true);
  const std::vector<bool> blocks(problem->layout().size(), true);
  Prediction plain(problem->layout());
  plain.Poison();
  const auto workspace = problem->NewWorkspace();
  ASSERT_TRUE(problem->Predict({truth, blocks, true, &base}, *workspace, plain));
  const Prediction almost = PredictEverything(*problem, With(*problem, {{"stiffness_exponent", 1e-15}}));
  for (int b = 0; b < static_cast<int>(problem->layout().size()); ++b) {
    EXPECT_EQ(Vector(plain.values(b)), Vector(all.values(b)));
    const auto& columns = problem->layout()[static_cast<std::size_t>(b)].columns;
    for (std::size_t c = 0; c < columns.size(); ++c) {
      const auto column = static_cast<Eigen::Index>(c);
      const Vector found = plain.derivatives(b).col(column);
      if (columns[c] < 5) {
        EXPECT_EQ(found, Vector(all.derivatives(b).col(column)));
      } else {
        EXPECT_TRUE(found.array().isNaN().all()) << "a column that was not asked for";
      }
      const Vector there = almost.derivatives(b).col(column);
      EXPECT_LT((there - all.derivatives(b).col(column)).norm(), kRounding * (1e-9 + there.norm()));
    }
  }
  EXPECT_LT(Difference(*problem, all, almost), kRounding);
}

// A sole that lies on a turned floor as it lay on the level one carries the turned force.
TEST(ContactEffects, ATiltedFloorCarriesTheTurnedSole) {
  constexpr double kRounding = 1e-11;
  Random random(7);
  ContactRegion region;
  region.mesh = *BoxMesh({0.16, 0.02, 0.09}, 12, 7);
  region.springs = SpringFaces::kBottom;
  const ElasticFoundation bed{8e5, 25, 0, 0, 0};
  const std::array<double, 2> reference{0.3, -0.1};
  const Vec3 pivot(reference[0], 0, reference[1]);
  for (int round = 0; round < 50; ++round) {
    BodyMotion level;
    level.position =
        pivot + Vec3(random.Uniform(-0.1, 0.1), random.Uniform(-0.006, 0), random.Uniform(-0.1, 0.1));
    level.rotation = Eigen::AngleAxisd(random.Uniform(-0.05, 0.05), Vec3(1, 2, 3).normalized()).matrix();
    level.velocity = Vec3(random.Uniform(-1, 1), random.Uniform(-0.03, 0.03), random.Uniform(-1, 1));
    const double slope_x = random.Uniform(-0.1, 0.1);
    const double slope_z = random.Uniform(-0.1, 0.1);
    const Vec3 normal = Vec3(-slope_x, 1, -slope_z).normalized();
    const Mat3 turn = Eigen::Quaterniond::FromTwoVectors(Vec3::UnitY(), normal).toRotationMatrix();
    BodyMotion turned;
    turned.position = pivot + turn * (level.position - pivot);
    turned.rotation = turn * level.rotation;
    turned.velocity = turn * level.velocity;

    const auto load_of = [&](const BodyMotion& motion, double x, double z) {
      EffectKinematics kinematics;
      kinematics.regions.push_back(Level(ComputeContactKinematics(region, {motion}, {})));
      kinematics.foot_position = {motion.position};
      kinematics.foot_acceleration = {motion.acceleration};
      kinematics.tilt_reference = reference;
      ContactEffectValues effects{};
      effects[kFloorSlopeX] = x;
      effects[kFloorSlopeZ] = z;
      EffectLoad load;
      load.by_part.resize(1);
      ComputeEffectLoad(kinematics, 0, {bed}, effects, {}, load);
      return Vec3(load.load.head<3>());
    };
    const Vec3 expected = turn * load_of(level, 0, 0);
    EXPECT_LT((load_of(turned, slope_x, slope_z) - expected).norm(), kRounding * (1 + expected.norm()));
  }
}

// Without dissipation two springs in series are one spring.
TEST(ContactEffects, AFloorThatGivesIsASofterSole) {
  constexpr double kRounding = 1e-12;
  const auto problem = Exact();
  const double k = kTruth.at("stiffness");
  const double give = 4e-7;
  const Vector series = Vertical(*problem, With(*problem, {{"dissipation", 0}, {"floor_compliance", give}}));
  const Vector soft =
      Vertical(*problem, With(*problem, {{"dissipation", 0}, {"stiffness", k / (1 + k * give)}}));
  EXPECT_GT(soft.maxCoeff(), 10);
  EXPECT_LT((series - soft).norm(), kRounding * soft.norm());
}

// Vertical force of a level sole of 0.02 m2 [N]. @param rate of its depth [m/s]
double ForceOfFlatSole(double depth, double rate, const ElasticFoundation& bed,
                       const ContactEffectValues& effects) {
  ContactRegion region;
  region.mesh = *BoxMesh({0.2, 0.02, 0.1}, 4, 4);
  region.springs = SpringFaces::kBottom;
  BodyMotion motion;
  motion.position = Vec3(0, -depth, 0);
  motion.velocity = Vec3(0, -rate, 0);
  EffectKinematics kinematics;
  kinematics.regions.push_back(Level(ComputeContactKinematics(region, {motion}, {})));
  kinematics.foot_position = {motion.position};
  kinematics.foot_acceleration = {motion.acceleration};
  EffectLoad load;
  load.by_part.resize(1);
  ComputeEffectLoad(kinematics, 0, {bed}, effects, {}, load);
  return load.load[kForceY];
}

TEST(ContactEffects, AFlatSoleFollowsThePowerOfItsDepth) {
  constexpr double kRounding = 1e-12;
  ContactEffectValues effects{};
  effects[kStiffnessExponent] = 0.5;
  for (const double depth : {0.0005, 0.001, 0.004}) {
    const double expected = 1e6 * 0.02 * kReferenceDepth * std::pow(depth / kReferenceDepth, 1.5);
    EXPECT_NEAR(ForceOfFlatSole(depth, 0, {1e6, 50, 0, 0, 0}, effects), expected, kRounding * expected);
  }
}

TEST(ContactEffects, LinearDampingIsAForcePerAreaAndRate) {
  constexpr double kRounding = 1e-12;
  ContactEffectValues effects{};
  effects[kLinearDamping] = 3e4;
  for (const double depth : {0.0005, 0.004}) {
    const double expected = 0.02 * (1e6 * depth + 3e4 * 0.2);
    EXPECT_NEAR(ForceOfFlatSole(depth, 0.2, {1e6, 0, 0, 0, 0}, effects), expected, kRounding * expected);
  }
}

// Natural logarithms of ratios: at the toes over at the heel, in the middle over at both ends, at the outer
// edge over at the inner one.
TEST(ContactEffects, UnevenStiffnessIsWhatItsRatiosSay) {
  constexpr double kRounding = 1e-12;
  const auto ratio = [](std::size_t mode, const StiffnessModes& there, const StiffnessModes& here) {
    return std::exp(0.7 * (there[mode] - here[mode]));
  };
  const double expected = std::exp(0.7);
  EXPECT_NEAR(ratio(0, StiffnessModesAt(1, 0.3), StiffnessModesAt(-1, -0.2)), expected, kRounding);
  EXPECT_NEAR(ratio(1, StiffnessModesAt(0, 0), StiffnessModesAt(1, 0)), expected, kRounding);
  EXPECT_NEAR(ratio(1, StiffnessModesAt(0, 0), StiffnessModesAt(-1, 0)), expected, kRounding);
  EXPECT_NEAR(ratio(2, StiffnessModesAt(0.5, 1), StiffnessModesAt(0.5, -1)), expected, kRounding);
  EXPECT_EQ(StiffnessModesAt(1.4, 0), StiffnessModesAt(1, 0)) << "beyond the sole, as at its end";
  StiffnessModes mean{};
  constexpr int kPlaces = 2000;
  for (int i = 0; i < kPlaces; ++i) {
    const double at = -1 + 2 * (i + 0.5) / kPlaces;
    for (std::size_t m = 0; m < kStiffnessModes; ++m) mean[m] += StiffnessModesAt(at, at)[m] / kPlaces;
  }
  for (const double one : mean) EXPECT_NEAR(one, 0, 1e-6);
}

// Of a real sole, and of the other foot mirrored.
TEST(ContactEffects, UnevenStiffnessMovesTheCentreOfPressureForwardAndOutward) {
  const auto problem = Exact(kFitsVertical, kFitsForce);
  const auto mean_shift = [&](const std::string& name, std::size_t channel, const Stance& stance) {
    const Vector truth = TruthOf(*problem);
    const int block = stance.blocks[channel];
    const Vector before = PredictEverything(*problem, truth).values(block);
    const Vector after = PredictEverything(*problem, With(*problem, {{name, 0.5}})).values(block);
    return (after - before).mean();
  };
  bool seen[2] = {false, false};
  for (const Stance& stance : problem->data().stances) {
    const double outward = stance.plate == "right" ? 1 : -1;
    seen[stance.plate == "right"] = true;
    EXPECT_GT(mean_shift("stiffness_toes_to_heel", kCopX, stance), 1e-4) << stance.trial;
    EXPECT_GT(outward * mean_shift("stiffness_outside_to_inside", kCopZ, stance), 1e-4) << stance.trial;
  }
  EXPECT_TRUE(seen[0] && seen[1]);
}

// Newton, with the acceleration from positions of the foot a little earlier and later.
TEST(ContactEffects, AnUnmodelledMassHasItsWeightAndItsInertia) {
  constexpr double kStep = 1e-3;  // [s]
  // Coordinates are cubics of time, heights are not quite: the fourth derivative times kStep^2 / 12, and at a
  // knot the jump of the third times kStep / 6.
  constexpr double kTolerance = 0.02;
  const Dataset& data = ExactData();
  const auto problem = Exact();
  const auto model =
      MultibodyModel::Build(ReadOsim(data.files.at("model.osim"), "model.osim").value()).value();
  const Stance& stance = problem->data().stances.front();
  const Grid& recorded = data.trials.at(stance.trial).grids.at("coordinates");
  const auto motion = RecordedMotion(model, recorded);
  const int body = model.BodyIndex("calcn_r").value();
  const auto height = [&](double t) {
    const CoordinateState state = motion.At(t);
    return model.BodyMotionAt(state.values, state.rates, {body}).value().front().position.y();
  };

  const double mass = 0.7;
  const Vector before = Vertical(*problem, TruthOf(*problem));
  const Vector after = Vertical(*problem, With(*problem, {{"unmodelled_mass", mass}}));
  double worst = 0;
  double largest = 0;
  for (Eigen::Index i = 0; i < before.size(); ++i) {
    if (before[i] == 0) {
      EXPECT_EQ(after[i], 0) << "a foot in the air";
      continue;
    }
    const double t = stance.time[static_cast<std::size_t>(i)];
    const double acceleration = (height(t + kStep) - 2 * height(t) + height(t - kStep)) / (kStep * kStep);
    largest = std::max(largest, std::abs(acceleration));
    worst = std::max(worst, std::abs(after[i] - before[i] - mass * (9.80665 + acceleration)));
  }
  std::printf("largest acceleration %.2f m/s2, worst difference %.2e N\n", largest, worst);
  EXPECT_GT(largest, 0.5) << "the weight alone would pass";
  EXPECT_LT(worst, kTolerance * mass * largest);
}

// The strips that missing regions add are what a person would write into the settings.
TEST(ContactEffects, AFullEdgeIsARegionOfTheSettings) {
  constexpr double kTolerance = 1e-9;
  std::string text = SettingsText(ExactData());
  const std::string strips = R"(
    - {name: SIDE_toe, body: calcn_SIDE, plate: PLATE, position: [0.116, -0.04519, 0.0],
       mesh: {box: {size: [0.032, 0.02, 0.09], strips: [4, 7]}}}
    - {name: SIDE_back, body: calcn_SIDE, plate: PLATE, position: [-0.076, -0.04519, 0.0],
       mesh: {box: {size: [0.032, 0.02, 0.09], strips: [4, 7]}}}
)";
  for (const auto& [side, plate] : {std::pair{"r", "right"}, std::pair{"l", "left"}}) {
    std::string of_side = strips;
    for (auto at = of_side.find("SIDE"); at != std::string::npos; at = of_side.find("SIDE"))
      of_side.replace(at, 4, side);
    for (auto at = of_side.find("PLATE"); at != std::string::npos; at = of_side.find("PLATE"))
      of_side.replace(at, 5, plate);
    text.insert(text.find("  parameters:"), of_side.substr(1));
  }
  const auto longer = MakeContact(ExactData(), text);
  ASSERT_TRUE(longer) << longer.error().message;
  const auto problem = Exact();
  const Prediction expected = PredictEverything(**longer, TruthOf(**longer));
  const Vector edges = With(*problem, {{"toe_region_weight", 1}, {"heel_region_weight", 1}});
  const Prediction found = PredictEverything(*problem, edges);
  double added = 0;
  for (const Stance& stance : problem->data().stances) {
    const auto force = expected.values(stance.blocks[kFy]);
    for (const ForceChannel channel : {kFx, kFy, kFz, kCopX, kCopZ, kPlateMomentY}) {
      const auto a = expected.values(stance.blocks[channel]);
      const auto b = found.values(stance.blocks[channel]);
      // Without pressure the centre of pressure rests under the deepest spring, which may be one of the
      // strip.
      const bool rests = channel == kCopX || channel == kCopZ;
      for (Eigen::Index i = 0; i < a.size(); ++i) {
        if (force[i] == 0 && rests) continue;
        EXPECT_NEAR(a[i], b[i], kTolerance * a.lpNorm<Eigen::Infinity>());
      }
    }
    added = std::max(
        added, (force - PredictEverything(*problem, TruthOf(*problem)).values(stance.blocks[kFy])).norm());
  }
  EXPECT_GT(added, 1);
}

// Derivatives are exact, parameter by parameter, at points where every effect is off its null.
// Asked for alone, the vertical force takes a shorter way.
TEST(ContactEffects, TheVerticalForceAloneIsThatOfTheWholeLoad) {
  const auto problem = Exact();
  std::vector<bool> vertical(problem->layout().size(), false);
  for (const Stance& stance : problem->data().stances)
    vertical[static_cast<std::size_t>(stance.blocks[kFy])] = true;
  const std::vector<bool> all(vertical.size(), true);
  const auto workspace = problem->NewWorkspace();
  Random random(5);
  for (int round = 0; round < 10; ++round) {
    const Vector point = RandomInside(*problem, 0.02, random);
    Prediction whole(problem->layout());
    Prediction with_slopes(problem->layout());
    Prediction alone(problem->layout());
    ASSERT_TRUE(problem->Predict({point, all, true, nullptr}, *workspace, whole));
    ASSERT_TRUE(problem->Predict({point, vertical, true, nullptr}, *workspace, with_slopes));
    ASSERT_TRUE(problem->Predict({point, vertical, false, nullptr}, *workspace, alone));
    for (const Stance& stance : problem->data().stances) {
      const int block = stance.blocks[kFy];
      EXPECT_EQ(alone.values(block), with_slopes.values(block));
      EXPECT_EQ(whole.values(block), alone.values(block));
      EXPECT_EQ(whole.derivatives(block), with_slopes.derivatives(block));
    }
  }
}

// The vertical force has a path of its own for a level floor and for a sole that keeps its shape, and leaves
// out regions that cannot touch: against the whole load, which has none of these.
TEST(ContactEffects, TheVerticalForceAloneLeavesOutWhatDoesNotMatter) {
  const auto problem = Exact();
  std::vector<bool> vertical(problem->layout().size(), false);
  for (const Stance& stance : problem->data().stances)
    vertical[static_cast<std::size_t>(stance.blocks[kFy])] = true;
  const std::vector<bool> all(vertical.size(), true);
  const auto of = [&](const Parameter& p, const std::string& what) { return p.name.rfind(what, 0) == 0; };
  const auto is_shape = [&](const Parameter& p) {
    return of(p, "foot_bend") || of(p, "foot_pitch") || of(p, "foot_height");
  };
  const auto workspace = problem->NewWorkspace();
  Random random(6);
  for (int round = 0; round < 32; ++round) {
    const bool level = round % 2 == 0;
    const bool rigid = round / 2 % 2 == 0;
    const bool straight = round / 4 % 2 == 0;
    const bool wants_all = round / 8 % 2 == 0;
    Vector point = RandomInside(*problem, 0.02, random);
    std::vector<bool> wanted(problem->parameters().size(), wants_all);
    for (std::size_t i = 0; i < wanted.size(); ++i) {
      const Parameter& p = problem->parameters()[i];
      const bool at_null = (level && of(p, "floor_slope")) || (rigid && is_shape(p)) ||
                           (straight && (of(p, "stiffness_exponent") || of(p, "floor_compliance")));
      if (at_null) point[static_cast<Eigen::Index>(i)] = 0;
      // As a search: what is off its null is fitted, and the base parameters.
      if (!at_null) wanted[i] = true;
    }
    Prediction whole(problem->layout());
    Prediction with_slopes(problem->layout());
    Prediction alone(problem->layout());
    ASSERT_TRUE(problem->Predict({point, all, true, nullptr}, *workspace, whole));
    ASSERT_TRUE(problem->Predict({point, vertical, true, &wanted}, *workspace, with_slopes));
    ASSERT_TRUE(problem->Predict({point, vertical, false, nullptr}, *workspace, alone));
    for (const Stance& stance : problem->data().stances) {
      const int block = stance.blocks[kFy];
      EXPECT_EQ(alone.values(block), with_slopes.values(block));
      EXPECT_EQ(whole.values(block), alone.values(block));
      const std::vector<int>& columns = problem->layout()[static_cast<std::size_t>(block)].columns;
      for (std::size_t c = 0; c < columns.size(); ++c) {
        if (!wanted[static_cast<std::size_t>(columns[c])]) continue;
        EXPECT_EQ(whole.derivatives(block).col(static_cast<Eigen::Index>(c)),
                  with_slopes.derivatives(block).col(static_cast<Eigen::Index>(c)))
            << problem->parameters()[static_cast<std::size_t>(columns[c])].name;
      }
    }
  }
}

TEST(ContactEffects, DerivativesAgreeWithDifferences) {
  Random random(3);
  for (const char* settings : {kFitsVertical, kFitsForce}) {
    const auto problem = Exact(kFitsVertical, settings);
    ExpectJacobianAgrees(*problem, random, kSoleWithMemory);
  }
}

}  // namespace
}  // namespace sinew
