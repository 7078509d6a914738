#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "base/constants.h"
#include "models/multibody/wrap_contact.h"

namespace sinew {
namespace {

constexpr double kCylinderTurn = 2 * kPi;
// Angles this little short of a full turn are a touch in one point, spoilt by rounding. [rad]
constexpr double kTouch = 1e-9;

// From `from` on to `to`, counter-clockwise, in 0..2 pi.
double Turn(double from, double to) {
  const double turn = std::remainder(to - from, kCylinderTurn);
  if (turn >= 0) return turn;
  return turn > -kTouch ? 0 : turn + kCylinderTurn;
}

double Between(double from, double to) {
  return std::abs(std::remainder(to - from, kCylinderTurn));
}

// In the projection along the axis: a point outside of a circle and its two tangents.
struct Outside {
  Outside(const Vec3& p, double r)
      : point(p),
        radius(r),
        tangent(std::sqrt(std::max(0.0, p.head<2>().squaredNorm() - r * r))),
        direction(std::atan2(p.y(), p.x())),
        opening(std::atan2(tangent, radius)) {}

  [[nodiscard]] double ahead() const { return direction + opening; }   // of the touch point counter-clockwise
  [[nodiscard]] double behind() const { return direction - opening; }  // and clockwise
  [[nodiscard]] Vec3 At(double angle, double z) const {
    return {radius * std::cos(angle), radius * std::sin(angle), z};
  }

  Vec3 point;
  double radius;
  double tangent;    // length of the line up to the touch point
  double direction;  // angle of the point
  double opening;    // angle at the axis between the point and a touch point
};

// How the line through both points passes the axis.
struct Passing {
  Passing(const Vec3& from, const Vec3& to, double radius) {
    const Vec3 along = to - from;
    const double squared = along.head<2>().squaredNorm();
    const double share = squared > 0 ? -from.head<2>().dot(along.head<2>()) / squared : 0;
    nearest = from + share * along;
    crosses = share > 0 && share < 1 && nearest.head<2>().squaredNorm() < radius * radius;
  }

  Vec3 nearest;  // to the axis
  bool crosses;  // the segment runs through the cylinder
};

// Whether both touch points lie beyond an end of the cylinder. OpenSim asks this of a first guess, before the
// helix is found: the touch lines' crossings with the plane through both points and an apex, which lies over
// the point of the straight line that divides it as the distances from the axis do. A guess that is not
// between both points counts as level with its own point.
bool IsBeyondEnds(const OsimWrapObject& cylinder, const Vec3& from, const Vec3& to, const Vec3& first,
                  const Vec3& last, bool far_side) {
  const double from_distance = from.head<2>().norm();
  const Vec3 middle = from + from_distance / (from_distance + to.head<2>().norm()) * (to - from);
  const double away = middle.head<2>().norm();
  Vec3 apex = middle;
  if (away > 0) apex.head<2>() *= (far_side ? -cylinder.radius : cylinder.radius) / away;
  const Vec3 normal = (from - apex).cross(to - apex);
  const auto is_beyond = [&](const Vec3& touch, const Vec3& near, const Vec3& other) {
    double z = near.z();
    if (normal.z() != 0) {
      const double guess = near.z() - normal.head<2>().dot((touch - near).head<2>()) / normal.z();
      if (std::abs(guess - other.z()) < std::abs(near.z() - other.z())) z = guess;
    }
    return std::abs(z) > cylinder.length / 2;
  };
  return is_beyond(first, from, to) && is_beyond(last, to, from);
}

WrapOutcome OutcomeOnSide(const OsimWrapObject& cylinder, const Vec3& from, const Vec3& to,
                          const Passing& passing) {
  const bool from_on_side = IsOnSide(cylinder, from);
  const bool to_on_side = IsOnSide(cylinder, to);
  if (!from_on_side && !to_on_side) return WrapOutcome::kPossible;
  if (passing.crosses) return WrapOutcome::kMandatory;
  const bool misses_on_other_side = from_on_side != to_on_side && !IsOnSide(cylinder, passing.nearest);
  return misses_on_other_side ? WrapOutcome::kPossible : WrapOutcome::kNone;
}

// The way round that touches the cylinder on its side; where that leaves both, OpenSim's choice.
bool IsCounterClockwiseOnSide(const OsimWrapObject& cylinder, const Outside& from, const Outside& to) {
  const auto on_side = [&](const Outside& end, double angle) {
    return IsOnSide(cylinder, end.At(angle, end.point.z()));
  };
  const bool leaves_counter = on_side(from, from.ahead());
  const bool leaves_clockwise = on_side(from, from.behind());
  if (leaves_counter != leaves_clockwise) return leaves_counter;
  if (on_side(to, to.ahead())) return false;
  if (leaves_counter || on_side(to, to.behind())) return true;
  return Between(from.ahead(), to.behind()) > Between(from.behind(), to.ahead());
}

}  // namespace

WrapContact FindCylinderContact(const OsimWrapObject& cylinder, const Vec3& from, const Vec3& to) {
  const double radius = cylinder.radius;
  WrapContact contact;
  if (from.head<2>().norm() < radius || to.head<2>().norm() < radius) {
    contact.outcome = WrapOutcome::kInside;
    return contact;
  }
  const Passing passing(from, to, radius);
  const Outside start(from, radius);
  const Outside end(to, radius);
  bool counter = Turn(start.direction, end.direction) <= kCylinderTurn / 2;
  contact.outcome = passing.crosses ? WrapOutcome::kMandatory : WrapOutcome::kNone;
  if (cylinder.side != 0) {
    contact.outcome = OutcomeOnSide(cylinder, from, to, passing);
    counter = IsCounterClockwiseOnSide(cylinder, start, end);
  }
  if (contact.outcome == WrapOutcome::kNone) return contact;

  const double leave = counter ? start.ahead() : start.behind();
  const double arrive = counter ? end.behind() : end.ahead();
  const double wound = radius * (counter ? Turn(leave, arrive) : Turn(arrive, leave));
  // Unrolled, the string is one straight line.
  const double unrolled = start.tangent + wound + end.tangent;
  const double slope = unrolled > 0 ? (to.z() - from.z()) / unrolled : 0;
  contact.first = start.At(leave, from.z() + slope * start.tangent);
  contact.last = end.At(arrive, to.z() - slope * end.tangent);
  contact.arc = std::hypot(wound, slope * wound);
  const double counter_gap = Between(start.ahead(), end.behind());
  const double clockwise_gap = Between(start.behind(), end.ahead());
  const bool far_side = cylinder.side != 0 && (counter_gap > clockwise_gap) == counter;
  if (IsBeyondEnds(cylinder, from, to, contact.first, contact.last, far_side))
    contact.outcome = WrapOutcome::kNone;
  return contact;
}

}  // namespace sinew
