// Finds the way of a muscle's path through space for given places of the bodies. Internal to models/.
#pragma once

#include <vector>

#include "models/multibody/body_motion.h"
#include "models/multibody/traced_muscle.h"

namespace sinew {

/// A corner of the path: an active point, or where the path meets or leaves an object.
struct PathCorner {
  int body = 0;
  Vec3 place = Vec3::Zero();  ///< [m], ground
  int point = -1;             ///< index into TracedMuscle::points; -1: a contact
  int wrap = -1;              ///< index into TracedMuscle::wraps; -1: a point
  double arc = 0;             ///< the length on the surface from the corner before to this one [m]
  bool after_arc = false;     ///< this corner and the one before are the two of one contact
};

struct TracedPath {
  std::vector<PathCorner> corners;  ///< from origin to insertion
  /// Whether the contacts with several objects came to rest. If not, the path jumps to and fro between two
  /// ways, of which this is one.
  bool settled = true;
};

/// @param values  [coordinates], couplers applied; @param poses  [bodies]. Errors: fewer than two points are
/// active.
Result<TracedPath> TracePath(const TracedMuscle& muscle, const Vector& values,
                             const std::vector<BodyMotion>& poses);

/// [m]
double LengthOf(const std::vector<PathCorner>& corners);

}  // namespace sinew
