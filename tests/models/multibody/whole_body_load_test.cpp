#include "models/multibody/whole_body_load.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "tests/models/multibody/test_models.h"

namespace sinew {
namespace {

using testing::HasSubstr;

const Vec3 kGravity(0, -9.81, 0);
constexpr double kUpperMass = 2;  // of PendulumText3
constexpr double kLowerMass = 1.5;

// A body on a free joint: three rotations about x, y, z in turn, then three translations.
std::string FreeBody() {
  std::string axes;
  std::string coordinates;
  const char* const names[] = {"rx", "ry", "rz", "tx", "ty", "tz"};
  const char* const directions[] = {"1 0 0", "0 1 0", "0 0 1"};
  for (int i = 0; i < 6; ++i) {
    const std::string kind = i < 3 ? "rotation" : "translation";
    axes += "<TransformAxis name=\"" + kind + std::to_string(i % 3 + 1) + "\"><coordinates>" + names[i] +
            "</coordinates><axis>" + directions[i % 3] +
            "</axis><LinearFunction name=\"function\"><coefficients> 1 0</coefficients></LinearFunction>"
            "</TransformAxis>";
    coordinates += std::string("<Coordinate name=\"") + names[i] + "\"/>";
  }
  return "<OpenSimDocument Version=\"40000\"><Model name=\"free\"><BodySet><objects><Body name=\"b\">"
         "<mass>3</mass><mass_center>0.1 0.2 -0.05</mass_center><inertia>0.4 0.5 0.6 0 0 0</inertia></Body>"
         "</objects></BodySet><JointSet><objects><CustomJoint name=\"j\"><socket_parent_frame>/ground"
         "</socket_parent_frame><socket_child_frame>/bodyset/b</socket_child_frame><coordinates>" +
         coordinates + "</coordinates><SpatialTransform>" + axes +
         "</SpatialTransform></CustomJoint></objects></JointSet></Model></OpenSimDocument>";
}

// Coordinates as functions of time, sampled so finely that their splines are exact to `kSpline`.
constexpr double kRate = 2000;
constexpr double kSpline = 2e-5;
template <class Function>
CoordinateTrajectory Sampled(const MultibodyModel& model, double length, const Function& at) {
  std::vector<double> times;
  for (double t = 0; t <= length; t += 1 / kRate) times.push_back(t);
  const auto count = static_cast<Eigen::Index>(model.coordinate_names().size());
  Matrix values(static_cast<Eigen::Index>(times.size()), count);
  for (std::size_t i = 0; i < times.size(); ++i) {
    for (Eigen::Index c = 0; c < count; ++c)
      values(static_cast<Eigen::Index>(i), c) =
          at(model.coordinate_names()[static_cast<std::size_t>(c)], times[i]);
  }
  return *CoordinateTrajectory::Fit(model, times, model.coordinate_names(), values);
}

TEST(WholeBodyLoad, ABodyAtRestWeighsWhatItWeighsWhereItIs) {
  const MultibodyModel model = BuildModel(PendulumText3());
  const auto still = Sampled(
      model, 0.01, [](const std::string& name, double) { return name == "shoulder_angle" ? 0.5 : 0.3; });
  const WholeBodyLoad load = WholeBodyLoads(model, kGravity, {0.005}, still)->front();
  const double weight = 9.81 * (kUpperMass + kLowerMass);
  EXPECT_NEAR((load.force - Vec3(0, weight, 0)).norm(), 0, 1e-9);
  const double upper = 0.25 * std::sin(0.5);
  const double lower = 0.5 * std::sin(0.5) + 0.2 * std::sin(0.8);
  EXPECT_NEAR(load.moment.z(), 9.81 * (kUpperMass * upper + kLowerMass * lower), 1e-9);
  EXPECT_NEAR(load.mass_centre.x(), (kUpperMass * upper + kLowerMass * lower) / (kUpperMass + kLowerMass),
              1e-12);
}

// A body that nothing carries: its mass centre falls, and it turns about it without a moment. Euler's
// equations are integrated here, for three different moments of inertia.
TEST(WholeBodyLoad, AFreeBodyNeedsNothing) {
  const MultibodyModel model = BuildModel(FreeBody());
  const Vec3 inertia(0.4, 0.5, 0.6);
  const Vec3 centre(0.1, 0.2, -0.05);
  const double step = 1 / kRate;
  struct State {
    Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();
    Vec3 spin = Vec3(1.5, 2, -1);  // in the body
  } state;
  const auto rate = [&](const Vec3& spin) {
    return Vec3((inertia.cwiseProduct(spin)).cross(spin).cwiseQuotient(inertia));
  };
  std::vector<double> times;
  std::vector<Vec3> angles;
  std::vector<Vec3> places;
  for (int i = 0; i <= 800; ++i) {
    const double t = i * step;
    const Mat3 r = state.turn.toRotationMatrix();
    times.push_back(t);
    // r = X(a) Y(b) Z(c)
    angles.emplace_back(std::atan2(-r(1, 2), r(2, 2)), std::asin(r(0, 2)), std::atan2(-r(0, 1), r(0, 0)));
    places.emplace_back(Vec3(0.3 * t, 1 + 2 * t, 0) + 0.5 * t * t * kGravity - r * centre);
    // Runge and Kutta's method of fourth order for the spin; the rotation by its values in the middle.
    const Vec3 k1 = rate(state.spin);
    const Vec3 k2 = rate(state.spin + 0.5 * step * k1);
    const Vec3 k3 = rate(state.spin + 0.5 * step * k2);
    const Vec3 k4 = rate(state.spin + step * k3);
    const Vec3 middle = state.spin + 0.5 * step * k2;
    state.spin += step / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
    state.turn =
        state.turn * Eigen::Quaterniond(Eigen::AngleAxisd(middle.norm() * step, middle.normalized()));
    state.turn.normalize();
  }
  Matrix values(static_cast<Eigen::Index>(times.size()), 6);
  for (std::size_t i = 0; i < times.size(); ++i)
    values.row(static_cast<Eigen::Index>(i)) << angles[i].transpose(), places[i].transpose();
  const auto motion =
      CoordinateTrajectory::Fit(model, times, {"rx", "ry", "rz", "tx", "ty", "tz"}, values).value();
  const auto loads = WholeBodyLoads(model, kGravity, {0.1, 0.2, 0.3}, motion).value();
  for (const WholeBodyLoad& load : loads) {
    EXPECT_NEAR(load.force.norm(), 0, 1e-3) << load.force.transpose();
    EXPECT_NEAR(load.moment.norm(), 0, 1e-3) << load.moment.transpose();
  }
}

TEST(WholeBodyLoad, ASwingingLinkNeedsWhatNewtonAndEulerSay) {
  const MultibodyModel model = BuildModel(PendulumText3());
  // The elbow is stretched and turns back as far as the shoulder turns on: the lower link does not turn.
  const double amplitude = 0.8;
  const double frequency = 5;
  const auto motion = Sampled(model, 1, [&](const std::string& name, double t) {
    return (name == "shoulder_angle" ? 1 : -1) * amplitude * std::sin(frequency * t);
  });
  const double t = 0.37;
  const WholeBodyLoad load = WholeBodyLoads(model, kGravity, {t}, motion)->front();
  const double angle = amplitude * std::sin(frequency * t);
  const double rate = amplitude * frequency * std::cos(frequency * t);
  const double change = -frequency * frequency * angle;
  const Vec3 along(std::cos(angle), std::sin(angle), 0);
  const Vec3 outward(std::sin(angle), -std::cos(angle), 0);
  const Vec3 upper = 0.25 * (change * along - rate * rate * outward);
  const Vec3 lower = 0.5 * (change * along - rate * rate * outward);
  EXPECT_NEAR((load.force - kUpperMass * (upper - kGravity) - kLowerMass * (lower - kGravity)).norm(), 0,
              kSpline * load.force.norm());
  const Vec3 upper_place = Vec3(0, 1, 0) + 0.25 * outward;
  const Vec3 lower_place = Vec3(0, 1, 0) + 0.5 * outward + Vec3(0, -0.2, 0);
  const Vec3 moment = upper_place.cross(kUpperMass * (upper - kGravity)) +
                      lower_place.cross(kLowerMass * (lower - kGravity)) + Vec3(0, 0, 0.05 * change);
  EXPECT_NEAR((load.moment - moment).norm(), 0, kSpline * moment.norm() + 1e-3);
}

TEST(WholeBodyLoad, SaysHowMuchMassACoordinateMoves) {
  const MultibodyModel model = BuildModel(PendulumText3());
  EXPECT_NEAR(*MassMovedBy(model, "shoulder_angle"), 1, 1e-12);
  EXPECT_NEAR(*MassMovedBy(model, "elbow_angle"), kLowerMass / (kUpperMass + kLowerMass), 1e-12);
}

TEST(WholeBodyLoad, AModelWithoutMassIsRefused) {
  std::string text = Replaced(PendulumText3(), "<mass>2</mass>", "<mass>0</mass>");
  text = Replaced(text, "<mass>1.5e+000</mass>", "<mass>0</mass>");
  const MultibodyModel model = BuildModel(text);
  const auto still = Sampled(model, 0.01, [](const std::string&, double) { return 0.0; });
  const auto loads = WholeBodyLoads(model, kGravity, {0}, still);
  ASSERT_FALSE(loads);
  EXPECT_THAT(loads.error().message, HasSubstr("have no mass"));
}

}  // namespace
}  // namespace sinew
