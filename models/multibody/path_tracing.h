// Finds the way of a muscle's path through space for given places of the bodies. Internal to models/.
#pragma once

#include <vector>

#include "base/error.h"
#include "models/multibody/body_motion.h"
#include "models/multibody/osim_muscle_path.h"

namespace sinew {

/// A muscle's path with bodies and coordinates as numbers.
struct TracedMuscle {
  struct Point {
    int body = 0;                  ///< index into the poses
    Vec3 location = Vec3::Zero();  ///< [m], body frame
    /// A point that is not always there: index of the coordinate, -1 if it always is.
    int condition = -1;
    double lower = 0;
    double upper = 0;
    /// A point that moves: index into the moving points, -1 if it is fixed.
    int moving = -1;
  };
  struct Component {
    int coordinate = -1;
    double lower = 0;  ///< the coordinate's range: beyond it the point stays where it is
    double upper = 0;
    PiecewisePolynomial function;
  };
  struct Moving {
    std::array<Component, 3> components;
    Vec3 origin;    ///< of the frame in which the components are, body frame
    Mat3 rotation;  ///< turns the components into the body's axes
  };
  struct Wrap {
    int body = 0;
    int object = 0;  ///< the same number for wraps over the same object
    OsimPathWrap description;
  };

  std::string name;
  std::vector<Point> points;
  std::vector<Moving> moving;
  std::vector<Wrap> wraps;
};

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

/// Where a moving point is in its body's frame [m]; and with rates of the coordinates how fast it moves there
/// [m/s].
Vec3 PlaceOf(const TracedMuscle::Moving& point, const Vector& values);
Vec3 VelocityOf(const TracedMuscle::Moving& point, const Vector& values, const Vector& rates);

/// @param values  [coordinates], couplers applied; @param poses  [bodies]. Errors: fewer than two points are
/// active.
Result<TracedPath> TracePath(const TracedMuscle& muscle, const Vector& values,
                             const std::vector<BodyMotion>& poses);

/// [m]
double LengthOf(const std::vector<PathCorner>& corners);

}  // namespace sinew
