// The shortest way of a taut string between two points round a cylinder or a sphere. Internal to models/.
#pragma once

#include "models/multibody/osim_muscle_path.h"

namespace sinew {

/// Whether a string between two points touches the object.
enum class WrapOutcome {
  kNone,       ///< it passes beside the object
  kInside,     ///< a point lies inside the object: no wrapping
  kPossible,   ///< it may be laid round; of several segments the one that this lengthens least wraps
  kMandatory,  ///< the straight line runs through the object
};

struct WrapContact {
  WrapOutcome outcome = WrapOutcome::kNone;
  /// Where the string meets the object and where it leaves it. [m]
  Vec3 first = Vec3::Zero();
  Vec3 last = Vec3::Zero();
  double arc = 0;  ///< length between them on the surface [m]
};

/// The contact of a string from `from` to `to`, both in the object's frame [m].
///
/// The string is straight up to the surface, follows a geodesic on it (a helix, a great circle) and leaves it
/// straight, tangent at both ends: its length is stationary when either tangent point is shifted on the
/// surface.
///
/// Whether and on which side it wraps follows OpenSim 4 (WrapCylinder, WrapSphere). Without a side given, it
/// wraps where the line runs through the object, on the shorter way. With a side given, it may also wrap
/// where the line misses the object on the other side, and then goes the long way round if need be. A
/// cylinder ends at its length: a string with both tangent points beyond does not wrap. Departure: OpenSim
/// finds the helix's tangent points to within 0.1 degree.
WrapContact FindWrapContact(const OsimWrapObject& object, const Vec3& from, const Vec3& to);

/// OpenSim counts points on the plane between the sides to the positive one.
inline bool IsOnSide(const OsimWrapObject& object, const Vec3& point) {
  return (point[object.side_axis] >= 0 ? 1 : -1) == object.side;
}

WrapContact FindCylinderContact(const OsimWrapObject& cylinder, const Vec3& from, const Vec3& to);
WrapContact FindSphereContact(const OsimWrapObject& sphere, const Vec3& from, const Vec3& to);

}  // namespace sinew
