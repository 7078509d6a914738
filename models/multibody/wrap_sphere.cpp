#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "base/constants.h"
#include "models/multibody/wrap_contact.h"

namespace sinew {
namespace {

constexpr double kSphereTurn = 2 * kPi;
// Below this sine of the angle between the points their plane is not determined.
constexpr double kOpposite = 1e-9;

// A unit vector at a right angle to `to`, on the side of `towards`; any one if both are in line.
Vec3 RightAngle(const Vec3& to, const Vec3& towards) {
  const Vec3 across = towards - towards.dot(to) * to;
  const double size = across.norm();
  return size > kOpposite ? Vec3(across / size) : Vec3(to.unitOrthogonal());
}

}  // namespace

WrapContact FindSphereContact(const OsimWrapObject& sphere, const Vec3& from, const Vec3& to) {
  const double radius = sphere.radius;
  const double from_distance = from.norm();
  const double to_distance = to.norm();
  WrapContact contact;
  if (from_distance < radius || to_distance < radius) {
    contact.outcome = WrapOutcome::kInside;
    return contact;
  }
  const Vec3 along = to - from;
  const double share = along.squaredNorm() > 0 ? -from.dot(along) / along.squaredNorm() : 0;
  const bool crosses = share > 0 && share < 1 && (from + share * along).norm() < radius;
  if (!crosses) return contact;

  const Vec3 start = from / from_distance;
  const Vec3 end = to / to_distance;
  const Vec3 start_across = RightAngle(start, end);
  const double angle = std::atan2(start_across.dot(end), start.dot(end));
  const Vec3 end_across = std::sin(angle) * start - std::cos(angle) * start_across;
  const double start_opening = std::acos(std::min(1.0, radius / from_distance));
  const double end_opening = std::acos(std::min(1.0, radius / to_distance));
  // In the plane of both points and the centre: +1 round the near side, -1 round the far side.
  const auto touch = [&](double side) {
    contact.first =
        radius * (std::cos(start_opening) * start + side * std::sin(start_opening) * start_across);
    contact.last = radius * (std::cos(end_opening) * end + side * std::sin(end_opening) * end_across);
    const double turn = side > 0 ? angle : kSphereTurn - angle;
    contact.arc = radius * std::max(0.0, turn - start_opening - end_opening);
  };

  contact.outcome = WrapOutcome::kPossible;
  touch(1);
  if (sphere.side == 0) return contact;
  const bool from_on_side = IsOnSide(sphere, from);
  const bool to_on_side = IsOnSide(sphere, to);
  if (from_on_side || to_on_side) contact.outcome = WrapOutcome::kMandatory;
  if (from_on_side && to_on_side) return contact;
  // The far side, if the string's pull there points to the side that is given.
  touch(-1);
  const Vec3 pull = (contact.first - from) + (contact.last - to);
  if (pull[sphere.side_axis] * sphere.side < 0) touch(1);
  return contact;
}

WrapContact FindWrapContact(const OsimWrapObject& object, const Vec3& from, const Vec3& to) {
  return object.shape == WrapShape::kCylinder ? FindCylinderContact(object, from, to)
                                              : FindSphereContact(object, from, to);
}

}  // namespace sinew
