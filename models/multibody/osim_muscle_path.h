// The path of a muscle in an OpenSim model file, as plain data.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "models/multibody/osim_model.h"

namespace sinew {

/// ConditionalPathPoint: the point belongs to the path only while the coordinate lies in lower..upper.
struct OsimPointCondition {
  std::string coordinate;
  double lower = 0;  ///< [rad or m]
  double upper = 0;
};

/// One component of where a MovingPathPoint is: a function [m] of a coordinate.
struct OsimPointComponent {
  std::string coordinate;  ///< empty: the function is taken at zero, a constant
  PiecewisePolynomial function;
};

struct OsimPathPoint {
  std::string name;
  OsimFrame frame;               ///< in which `location` and `motion` are given
  Vec3 location = Vec3::Zero();  ///< [m]; of no meaning with a motion
  std::optional<OsimPointCondition> condition;
  std::optional<std::array<OsimPointComponent, 3>> motion;
};

enum class WrapShape { kCylinder, kSphere };

/// A surface fixed to a body over which paths wrap. The cylinder's axis is z of its frame, its middle the
/// frame's origin.
struct OsimWrapObject {
  std::string name;
  WrapShape shape = WrapShape::kCylinder;
  OsimFrame frame;
  double radius = 0;  ///< [m], > 0
  double length = 0;  ///< [m], >= 0; of the cylinder
  int side_axis = 0;  ///< 0, 1, 2: x, y, z of the frame
  int side = 0;       ///< -1 or 1: the path goes round on that side of the axis; 0: on the shorter way
};

/// Which part of a path may wrap over an object: the segments between two points.
struct OsimPathWrap {
  OsimWrapObject object;
  int first = 0;  ///< index into OsimMusclePath::points
  int last = 0;   ///< inclusive
};

/// A muscle and its tendons from origin to insertion.
struct OsimMusclePath {
  std::string name;
  std::vector<OsimPathPoint> points;  ///< at least two
  std::vector<OsimPathWrap> wraps;    ///< in the file's order, which matters where a path has several
};

}  // namespace sinew
