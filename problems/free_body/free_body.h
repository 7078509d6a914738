// A rigid body that falls, bounces and slides on a table: what its motion depends on. SCIENCE section 4,
// forward case.
//
// The world has z up; the table is a plane near z = 0. The body touches it at points, each with a spring:
//   force of a point   n = k a x^p (1 + r c v) (1 - u [unloading]), never pulling
//     vertices (Hunt, Crossley 1975)      a = 1, p = 3/2, r = 3/2; points are the corners
//     elastic foundation (thesis eq 5.1)  a = area of a face's element, p = 1, r = 1; points are its centres
//   friction           n ( min(s/vt, 1) (mu_d + 2 (mu_s - mu_d) / (1 + (s/vt)^2)) + mu_v s )   (Hollars,
//   eq 5.2)
// x depth, v depth rate, s slip speed.
#pragma once

#include <array>
#include <vector>

#include "base/linear_algebra.h"

namespace sinew {

/// Everything that the motion depends on, by place. Effects vanish at 0.
enum FreeBodySlot {
  kStiffness,     ///< k [N/m^1.5, or N/m3 = Pa/m]
  kDissipation,   ///< c [s/m]
  kFriction,      ///< mu_d [1]
  kStaticExcess,  ///< mu_s - mu_d [1]
  kViscousSlip,   ///< mu_v [s/m]
  kReboundLoss,   ///< u, share of the force that is lost while the point comes out [1]
  kExponent,      ///< p less that of the model [1]
  kCornerRadius,  ///< of balls at the corners; vertices only [m]
  kSizeError,     ///< edges are longer by this share [1]
  kInertiaShare,  ///< moments of inertia are larger by this share [1]
  kMassCentreX,   ///< from the middle of the box [m]
  kMassCentreY,
  kMassCentreZ,
  kAirDrag,       ///< deceleration per squared speed [1/m]
  kGravityShare,  ///< gravity is stronger by this share [1]
  kGravityTiltX,  ///< gravity's part along x, as a share [1]
  kGravityTiltY,
  kTableHeight,  ///< [m]
  kTableSlopeX,  ///< rise along x [1]
  kTableSlopeY,
  kLengthShare,  ///< recorded lengths are too large by this share [1]
  kClockShare,   ///< more time passes than is recorded, by this share [1]
  kPoseLowPass,  ///< time constant of the smoothing of the recorded pose [s]
  kFrameTurnX,   ///< turn of the recorded body axes [rad]
  kFrameTurnY,
  kFrameTurnZ,
  kFramePointX,  ///< recorded point, from the middle of the box [m]
  kFramePointY,
  kFramePointZ,
  kSlipTerm,                      ///< unknown friction coefficient at each knot of the slip speed [1]
  kApproachTerm = kSlipTerm + 7,  ///< unknown share of the normal force at each knot of the depth rate [1]
  kFreeBodySlots = kApproachTerm + 7
};
constexpr int kFreeBodyKnots = 7;

/// Position [m], orientation as a turn of the start's axes [rad], velocity [m/s] and angular velocity in body
/// axes [rad/s] at the begin of a window.
constexpr int kStartLanes = 12;

enum class FreeBodyContact { kVertices, kElasticFoundation };

/// A place of the body that may touch.
struct ContactPoint {
  Vec3 place = Vec3::Zero();   ///< from the middle [m]
  Vec3 inward = Vec3::Zero();  ///< change of place per radius of a ball there [1]
  double weight = 1;           ///< a of the force
};

struct FreeBody {
  FreeBodyContact contact = FreeBodyContact::kVertices;
  std::vector<ContactPoint> points;
  double mass = 1;                           ///< [kg]
  Vec3 inertia = Vec3::Ones();               ///< about the body's axes [kg m2]
  double gravity = 9.81;                     ///< [m/s2]
  double transition_velocity = 0.01;         ///< vt [m/s]
  double size = 0.1;                         ///< half of the longest edge [m]
  double reach = 0.1;                        ///< from the middle to the farthest point [m]
  double accuracy = 1e-8;                    ///< of the integrator
  double most_steps = 0;                     ///< of the integrator in one simulation; 0: by its frames
  std::array<std::vector<double>, 2> knots;  ///< [kFreeBodyKnots] slip speed, depth rate [m/s]
};

/// Corners of a box, or centres of divisions^2 elements of each of its faces.
/// @param edges [m, > 0] @param divisions [>= 1]
[[nodiscard]] std::vector<ContactPoint> PointsOfBox(const Vec3& edges, FreeBodyContact contact,
                                                    int divisions);

/// A recorded or predicted pose: position x y z [m], orientation w x y z.
using Pose = std::array<double, 7>;
constexpr int kPoseChannels = 7;

}  // namespace sinew
