// The elastic foundation: a bed of springs, one at the centre of each face of the sole, with Hollars
// friction.
//
//   normal force of a face  n = k a x (1 + c v), never tensile
//   friction of a face      n ( min(s/vt, 1) (mu_d + 2 (mu_s - mu_d) / (1 + (s/vt)^2)) + mu_v s )
//
// a area, x depth, v depth rate, s slip speed. Thesis eq 5.1 (as Simbody's ElasticFoundationForce) and 5.2
// (Hollars). With prescribed motion the force of a stance is an algebraic function of the kinematics: the
// part that depends on the kinematics alone (ContactKinematics, computed once) is separated from the part
// that depends on the parameters (ContactSums, a few sums per instant).
#pragma once

#include <string>
#include <vector>

#include "base/linear_algebra.h"
#include "models/contact/contact_mesh.h"
#include "models/multibody/body_motion.h"

namespace sinew {

/// Parameters of one group of contact regions.
struct ElasticFoundation {
  double stiffness = 1e6;       ///< k [N/m3: pressure per depth, > 0]
  double dissipation = 0;       ///< c [s/m, >= 0]
  double static_friction = 0;   ///< mu_s [1, >= 0]
  double dynamic_friction = 0;  ///< mu_d [1, >= 0]
  double viscous_friction = 0;  ///< mu_v [s/m, >= 0]
};

/// Which faces of a mesh carry a spring.
enum class SpringFaces {
  kBottom,  ///< those that face down in the frame of the mesh: a sole that sinks deep is not supported by its
            ///< sides and top
  kAll      ///< the whole closed mesh, as in Simbody
};

/// A sole mesh on a body.
struct ContactRegion {
  std::string name;
  ContactMesh mesh;
  SpringFaces springs = SpringFaces::kAll;
  Vec3 position = Vec3::Zero();      ///< origin of the mesh in the frame of the body [m]
  Mat3 rotation = Mat3::Identity();  ///< mesh to body

  /// Indices of the faces that carry a spring.
  [[nodiscard]] std::vector<int> SpringFaceIndices() const;
};

/// The half-space y <= height; its surface may move, as the belt of a treadmill does.
struct Floor {
  double height = 0;      ///< [m]
  double velocity_x = 0;  ///< [m/s]
  double velocity_z = 0;
};

/// Kinematics of every spring of a region at every instant, touching or not.
///
/// Arrays are [instants x faces], row-major: all faces of one instant are adjacent.
struct ContactKinematics {
  int instants = 0;
  int faces = 0;
  std::vector<double> area;    ///< [faces, m2]
  std::vector<double> depth;   ///< below the floor [m]; negative above it
  std::vector<double> rate;    ///< of the depth [m/s], at the point of the floor nearest to the spring
  std::vector<double> slip_x;  ///< velocity of the sole over the floor there [m/s]
  std::vector<double> slip_z;
  std::vector<double> point_x;  ///< that point [m, world]: the lever arm of the force
  std::vector<double> point_z;
};

/// @param motion of the body that carries the region, one per instant.
[[nodiscard]] ContactKinematics ComputeContactKinematics(const ContactRegion& region,
                                                         const std::vector<BodyMotion>& motion,
                                                         const Floor& floor);

/// Force of the floor on the sole, and its moment about the point of the floor below (or above) the world's
/// origin.
struct ContactWrench {
  Vec3 force = Vec3::Zero();   ///< [N]
  Vec3 moment = Vec3::Zero();  ///< [N m]
};

/// One instant directly from the equations, face by face: the reference for the fast path, and the source of
/// pressure figures.
struct FaceLoad {
  double pressure = 0;  ///< [Pa]
  double slip = 0;      ///< [m/s]
};
ContactWrench ContactWrenchAt(const ContactKinematics& kinematics, int instant,
                              const ElasticFoundation& parameters, double transition_velocity,
                              std::vector<FaceLoad>* loads = nullptr);

}  // namespace sinew
