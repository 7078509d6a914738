// The fast path, the equations face by face, and Simbody's own force give the same force.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "base/random.h"
#include "models/contact/contact_sums.h"
#include "models/contact/elastic_foundation.h"
#include "models/contact/simbody_contact.h"

namespace sinew {
namespace {

constexpr double kTransitionVelocity = 0.01;
constexpr double kFloorHeight = 0.02;

ContactRegion Sole() {
  ContactRegion region;
  region.name = "sole";
  region.mesh = *BoxMesh({0.16, 0.02, 0.09}, 8, 5);
  region.position = {0.02, -0.045, 0.01};
  region.rotation = Eigen::AngleAxisd(0.1, Vec3(0.3, 1, 0.2).normalized()).toRotationMatrix();
  return region;
}

// A sole near the floor: most of these touch with a part of their faces.
BodyMotion RandomMotion(Random& random) {
  const auto vector = [&](double size) {
    return Vec3(random.Uniform(-size, size), random.Uniform(-size, size), random.Uniform(-size, size));
  };
  BodyMotion motion;
  motion.position =
      Vec3(random.Uniform(-1, 1), kFloorHeight + random.Uniform(0.025, 0.05), random.Uniform(-1, 1));
  motion.rotation = Eigen::AngleAxisd(random.Uniform(-0.2, 0.2), vector(1).normalized()).toRotationMatrix();
  motion.velocity = vector(0.5);
  motion.angular_velocity = vector(2);
  return motion;
}

ElasticFoundation RandomParameters(Random& random) {
  return {std::pow(10, random.Uniform(4, 9)), random.Uniform(0, 600), random.Uniform(0, 15),
          random.Uniform(0, 15), random.Uniform(0, 15)};
}

ContactLoad FastLoad(const ContactSums& sums, int instant, const ElasticFoundation& p,
                     ContactLoadJacobian* jacobian = nullptr, WrenchParts parts = WrenchParts::kAll) {
  auto workspace = sums.NewWorkspace();
  ContactLoad load = ContactLoad::Zero();
  sums.Add(instant, p, parts, workspace, load, jacobian);
  return load;
}

TEST(ContactPaths, FastPathEqualsSimbodyOnAThousandRandomStates) {
  constexpr int kTouchingStates = 1000;
  constexpr double kTolerance =
      1e-9;  // both sum some hundred faces in double precision, Simbody after more rotations
  Random random(1);
  const ContactRegion region = Sole();
  int touching = 0;
  int clear = 0;
  double worst = 0;
  while (touching < kTouchingStates) {
    const BodyMotion motion = RandomMotion(random);
    const ElasticFoundation p = RandomParameters(random);
    const ContactKinematics kinematics = ComputeContactKinematics(region, {motion}, {kFloorHeight});
    const ContactLoad load = FastLoad(ContactSums({&kinematics}, kTransitionVelocity), 0, p);
    SimbodyContact simbody({region}, {p}, kTransitionVelocity, kFloorHeight);
    const auto wrenches = simbody.WrenchesAt({motion});
    ASSERT_TRUE(wrenches) << wrenches.error().message;
    const Vec3& force = wrenches->front().force;
    const Vec3& moment = wrenches->front().moment;
    if (force.norm() == 0) {
      ASSERT_EQ(load.norm(), 0);
      ++clear;
      continue;
    }
    ++touching;
    const double scale = force.norm();
    worst = std::max(worst, (load.head<3>() - force).norm() / scale);
    worst = std::max(worst, std::abs(load[kMomentY] - moment.y()) / scale);
    // A normal force n at (x, z) of the floor has the moment M_z = n x and M_x = -n z.
    worst = std::max(worst, std::abs(load[kFirstMomentX] - moment.z()) / scale);
    worst = std::max(worst, std::abs(load[kFirstMomentZ] + moment.x()) / scale);
  }
  std::printf("worst relative difference %.2e over %d touching states (%d clear of the floor)\n", worst,
              touching, clear);
  EXPECT_LT(worst, kTolerance);
}

TEST(ContactPaths, FastPathEqualsTheEquationsFaceByFace) {
  constexpr double kTolerance = 1e-12;  // the same sums in another order
  Random random(2);
  const ContactRegion region = Sole();
  for (int state = 0; state < 200; ++state) {
    const ElasticFoundation p = RandomParameters(random);
    const auto kinematics =
        ComputeContactKinematics(region, {RandomMotion(random), RandomMotion(random)}, {kFloorHeight});
    const ContactSums sums({&kinematics}, kTransitionVelocity);
    for (int instant = 0; instant < 2; ++instant) {
      const ContactWrench wrench = ContactWrenchAt(kinematics, instant, p, kTransitionVelocity);
      const ContactLoad load = FastLoad(sums, instant, p);
      const double scale = std::max(1e-300, wrench.force.norm());
      EXPECT_LT((load.head<3>() - wrench.force).norm(), kTolerance * scale);
      EXPECT_LT(std::abs(load[kMomentY] - wrench.moment.y()), kTolerance * scale);
    }
  }
}

TEST(ContactPaths, JacobianAgreesWithDifferences) {
  constexpr double kTolerance = 1e-6;
  Random random(3);
  const ContactRegion region = Sole();
  double worst = 0;
  for (int state = 0; state < 200; ++state) {
    const ElasticFoundation p = RandomParameters(random);
    const auto kinematics = ComputeContactKinematics(region, {RandomMotion(random)}, {kFloorHeight});
    const ContactSums sums({&kinematics}, kTransitionVelocity);
    ContactLoadJacobian jacobian;
    const ContactLoad load = FastLoad(sums, 0, p, &jacobian);
    if (load[kForceY] == 0) continue;
    for (int column = 0; column < 5; ++column) {
      const auto stepped = [&](double step) {
        ElasticFoundation q = p;
        double* values[] = {&q.stiffness, &q.dissipation, &q.static_friction, &q.dynamic_friction,
                            &q.viscous_friction};
        *values[column] += step;
        return FastLoad(sums, 0, q);
      };
      const double size[] = {p.stiffness, 1, 1, 1, 1};
      const double h = 1e-4 * size[column];
      // The wrench is linear in all but the dissipation, and in that piecewise: the kink of a face that
      // starts to pull within the step is no error of the derivative.
      const ContactLoad right = (stepped(h) - load) / h;
      const ContactLoad left = (load - stepped(-h)) / h;
      const double scale = std::max(jacobian.col(column).norm(), 1e-9 * load.norm());
      if ((right - left).norm() > 1e-6 * scale) continue;
      worst = std::max(worst, (jacobian.col(column) - 0.5 * (right + left)).norm() / scale);
    }
  }
  std::printf("worst relative difference of the Jacobian %.2e\n", worst);
  EXPECT_LT(worst, kTolerance);
}

TEST(ContactPaths, PartialRequestsGiveTheSameNumbers) {
  Random random(4);
  const ContactRegion region = Sole();
  for (int state = 0; state < 50; ++state) {
    const ElasticFoundation p = RandomParameters(random);
    const auto kinematics = ComputeContactKinematics(region, {RandomMotion(random)}, {kFloorHeight});
    const ContactSums sums({&kinematics}, kTransitionVelocity);
    const ContactLoad all = FastLoad(sums, 0, p);
    EXPECT_EQ(FastLoad(sums, 0, p, nullptr, WrenchParts::kVertical)[kForceY], all[kForceY]);
    EXPECT_EQ(FastLoad(sums, 0, p, nullptr, WrenchParts::kForce).head<3>(), all.head<3>());
  }
}

TEST(ContactPaths, SidesAndTopHaveNoForceIfOnlyTheBottomHasSprings) {
  ContactRegion region;
  region.mesh = *BoxMesh({0.2, 0.02, 0.1}, 4, 4);
  BodyMotion motion;
  motion.position = Vec3(0, -0.05, 0);  // deeper than the sole is thick
  for (const SpringFaces springs : {SpringFaces::kBottom, SpringFaces::kAll}) {
    region.springs = springs;
    const auto kinematics = ComputeContactKinematics(region, {motion}, {});
    const double force =
        FastLoad(ContactSums({&kinematics}, kTransitionVelocity), 0, {1e6, 0, 0, 0, 0})[kForceY];
    const double bottom_alone = 1e6 * 0.02 * 0.05;
    if (springs == SpringFaces::kBottom) {
      EXPECT_NEAR(force, bottom_alone, 1e-9);
    } else {
      EXPECT_GT(force, 1.5 * bottom_alone);
    }
  }
}

// A foot that moves with the belt of a treadmill does not slip.
TEST(ContactPaths, SlipIsMeasuredAgainstTheMovingFloor) {
  ContactRegion region = Sole();
  BodyMotion motion;
  motion.position = Vec3(0, 0.04, 0);
  motion.velocity = Vec3(-1.2, 0, 0);
  const auto on_belt = ComputeContactKinematics(region, {motion}, {0, -1.2, 0});
  const auto on_ground = ComputeContactKinematics(region, {motion}, {});
  const ElasticFoundation p{1e6, 0, 0.8, 0.6, 0};
  EXPECT_EQ(FastLoad(ContactSums({&on_belt}, kTransitionVelocity), 0, p)[kForceX], 0);
  EXPECT_GT(FastLoad(ContactSums({&on_ground}, kTransitionVelocity), 0, p)[kForceX], 0);
}

// A sole that lies flat at depth d on a level floor: F = k A d, whatever the mesh.
TEST(ContactPaths, FlatSoleCarriesStiffnessTimesAreaTimesDepth) {
  for (const int strips : {1, 4, 16}) {
    ContactRegion region;
    region.mesh = *BoxMesh({0.2, 0.02, 0.1}, strips, strips);
    BodyMotion motion;
    motion.position = Vec3(0, -0.004, 0);
    const auto kinematics = ComputeContactKinematics(region, {motion}, {});
    const ContactLoad load = FastLoad(ContactSums({&kinematics}, kTransitionVelocity), 0, {1e6, 50, 1, 1, 1});
    EXPECT_NEAR(load[kForceY], 1e6 * 0.02 * 0.004, 1e-9);
    EXPECT_EQ(load[kForceX], 0);
  }
}

}  // namespace
}  // namespace sinew
