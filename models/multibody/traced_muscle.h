// A muscle's path as it is evaluated: bodies and coordinates are numbers of a model. Internal to models/.
#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

#include "base/linear_algebra.h"
#include "models/multibody/multibody_model.h"
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

/// @param object_numbers  of the wrap objects seen so far, by name; the path's own are added.
/// Errors: a body or coordinate that the model lacks.
Result<TracedMuscle> NumberPath(const MultibodyModel& model, const OsimMusclePath& path,
                                std::map<std::string, int>& object_numbers);

/// Where a moving point is in its body's frame [m]; and with rates of the coordinates how fast it moves there
/// [m/s].
Vec3 PlaceOf(const TracedMuscle::Moving& point, const Vector& values);
Vec3 VelocityOf(const TracedMuscle::Moving& point, const Vector& values, const Vector& rates);

}  // namespace sinew
