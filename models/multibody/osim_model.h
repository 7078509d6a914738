// The bodies, joints, couplers and markers of an OpenSim model file, as plain data.
#pragma once

#include <array>
#include <limits>
#include <string>
#include <vector>

#include "base/linear_algebra.h"
#include "models/multibody/piecewise_polynomial.h"

namespace sinew {

/// The name by which joints and markers refer to the world.
inline constexpr const char* kGround = "ground";

struct OsimBody {
  std::string name;
  double mass_kg = 0;               ///< >= 0
  Vec3 mass_center = Vec3::Zero();  ///< [m], body frame
  Mat3 inertia = Mat3::Zero();      ///< [kg m2], about the mass centre, body axes
};

/// A frame fixed to a body or to ground.
struct OsimFrame {
  std::string body = kGround;
  Vec3 location = Vec3::Zero();      ///< [m], body frame
  Mat3 rotation = Mat3::Identity();  ///< turns vectors of the frame into the body's axes
};

/// Whether a coordinate is an angle, a length, or moves its joint through functions only. Motion files give
/// angles in degrees, the other two never.
enum class MotionType { kRotational, kTranslational, kCoupled };

struct OsimCoordinate {
  std::string name;
  MotionType motion = MotionType::kRotational;
  bool is_angle = true;      ///< its number is one: kRotational, or kCoupled and a rotation follows from it
  double default_value = 0;  ///< [rad or m]
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
  bool clamped = false;  ///< inverse kinematics keeps it within lower..upper
  bool locked = false;   ///< inverse kinematics keeps it at its default
};

/// One axis of a joint: a rotation about it [rad], or a translation along it [m], given by a function of one
/// coordinate.
struct OsimAxis {
  std::string coordinate;     ///< empty: the function is taken at zero, a constant
  Vec3 axis = Vec3::UnitX();  ///< only its direction counts
  PiecewisePolynomial function;
};

/// How the child frame moves in the parent frame: rotations about axes 0, 1, 2 in turn, each fixed to the
/// frame that the ones before have turned, then a translation along axes 3, 4, 5 of the parent frame. Joints
/// of every type are written this way; a joint without coordinates is a weld.
struct OsimJoint {
  std::string name;
  std::string type;  ///< as in the file, "PinJoint"
  OsimFrame parent;
  OsimFrame child;
  std::vector<OsimCoordinate> coordinates;
  std::array<OsimAxis, 6> axes;
};

/// CoordinateCouplerConstraint: dependent = function(independent).
struct OsimCoupler {
  std::string name;
  std::string independent;
  std::string dependent;
  PiecewisePolynomial function;
};

struct OsimMarker {
  std::string name;
  std::string body;
  Vec3 location = Vec3::Zero();  ///< [m], body frame
};

struct OsimModel {
  std::string name;
  Vec3 gravity = Vec3(0, -9.80665, 0);  ///< [m/s2]
  std::vector<OsimBody> bodies;         ///< without ground
  std::vector<OsimJoint> joints;
  std::vector<OsimCoupler> couplers;
  std::vector<OsimMarker> markers;
};

}  // namespace sinew
