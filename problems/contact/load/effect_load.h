// The load on a plate with contact effects in it: face by face, from kinematics that were computed once. Slow
// against ContactSums (by a factor of about ten), and needed only while an effect is off its null or its
// derivative is wanted.
//
// With e = height offset + slope_x (x - x_ref) + slope_z (z - z_ref) the rise of the floor under a spring, N
// = sqrt(1 + slope_x^2 + slope_z^2):
//   depth of the spring      (d + e) / N
//   its rate                 -(velocity of the sole at the floor) . (normal of the floor)
//   force of the floor       (-slope_x, 1, -slope_z) / N times the normal force, and friction
// where the velocity is that of the sole's material at the raised floor. A sole that is displaced upwards
// (ShapeMode) has e less by that, and the rate less by its rate. Friction stays horizontal and follows the
// horizontal slip: its share along y and the slip's change by the tilt are of the order of friction times
// slope and slip times slope^2, and are left out. The lever arm is that of the point straight below the
// spring.
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "models/contact/contact_sums.h"
#include "problems/contact/effects.h"

namespace sinew {

/// Kinematics of one region, and the rotation of its body, which gives the slip at another height of the
/// floor.
struct EffectRegion {
  int part = 0;  ///< index into Stance::parts: whose parameters it has
  ContactKinematics kinematics;
  std::vector<double> turning_x;  ///< angular velocity of the body about the world's x [T, rad/s]
  std::vector<double> turning_z;
  std::vector<double> ahead;  ///< of the sole's middle [faces, m]; empty: it keeps its shape and pose
  std::vector<StiffnessModes> stiffness_modes;  ///< [faces]; empty: as stiff everywhere
  double reach = 0;                             ///< largest magnitude of `ahead` [m]
  std::vector<double> deepest;                  ///< depth of the lowest spring [T, m]; empty: not known
};

/// What a stance needs besides ContactSums.
struct EffectKinematics {
  std::vector<EffectRegion> regions;
  std::array<std::vector<EffectRegion>, 2>
      edges;                               ///< toe, heel: strips that carry by kToeRegion, kHeelRegion
  std::vector<Vec3> foot_position;         ///< of the foot's body [T, m]
  std::vector<Vec3> foot_acceleration;     ///< [T, m/s2]
  std::array<double, 2> tilt_reference{};  ///< x, z [m] where slopes leave the floor's height alone: the
                                           ///< middle of all stances' soles
  std::array<double, 2> floor_velocity{};  ///< x, z [m/s]
  double transition_velocity = 0.01;       ///< [m/s]
  std::vector<PhaseShare> phase;           ///< [T]; empty: the foot keeps its shape and pose
};

/// Derivatives of the load of one spring for what its place and motion decide: SpringQuantity.
enum SpringQuantity {
  kDepth,
  kRate,
  kSlipX,
  kSlipZ,
  kPointX,
  kPointZ,
  kTurningX,
  kTurningZ,
  kSpringQuantities
};
using SpringGradient = Eigen::Matrix<double, 6, kSpringQuantities>;

using ContactEffectJacobian = Eigen::Matrix<double, 6, static_cast<int>(kContactEffects)>;

/// How a load answers to a velocity of all springs along x and z, EffectLoadQuery::shear_velocity.
struct SlipResponse {
  Eigen::Matrix<double, 6, 2> jacobian = Eigen::Matrix<double, 6, 2>::Zero();  ///< of the ContactLoad
  double potential = 0;  ///< with EffectLoadQuery::slip: the horizontal force is minus its gradient [N m/s]
};

/// Load and derivatives of one instant.
struct EffectLoad {
  ContactLoad load = ContactLoad::Zero();
  ContactLoad of_springs = ContactLoad::Zero();  ///< the same without kUnmodelledMass
  std::vector<ContactLoadJacobian> by_part;      ///< [parts] for k, c, mu_s, mu_d, mu_v of each
  ContactEffectJacobian by_effect = ContactEffectJacobian::Zero();  ///< but for kShearCompliance
  SlipResponse by_slip;
  /// [regions, then edges][faces] with EffectLoadQuery::springs: zero for a spring that does not touch.
  std::vector<std::vector<SpringGradient>> by_spring;
};

/// What of an EffectLoad is asked for; the rest of it is not to be used.
struct EffectLoadQuery {
  bool vertical_only = false;  ///< the vertical force alone: no friction, no moments
  bool derivatives = true;     ///< by_part, by_effect and the jacobian of by_slip too
  bool edges = false;          ///< strips of weight 0 too, for the derivative of the weight
  bool springs = false;  ///< EffectLoad::by_spring, which has the right size; with derivatives, not with
                         ///< vertical_only
  /// With vertical_only and derivatives: columns of EffectLoad::by_effect that are wanted. Those of the
  /// exponent, the slopes and the shape cost time.
  std::array<bool, kContactEffects> effects{};
  bool slip = false;  ///< by_slip without the other derivatives; not with vertical_only
  /// Velocity of the springs' lower ends against the foot along x and z: the sole gives way (SoleShear)
  /// [m/s].
  std::array<double, 2> shear_velocity{};

  [[nodiscard]] bool wants(std::size_t effect) const { return effects[effect]; }
  [[nodiscard]] bool wants_shape() const {
    return std::any_of(effects.begin() + kFirstShape, effects.begin() + kLastShape + 1,
                       [](bool one) { return one; });
  }
};

/// Fills `load`, whose by_part has the right size. Allocates nothing.
/// @param beds [parts]; @param effects kHeightOffset with the plate's own added.
void ComputeEffectLoad(const EffectKinematics& kinematics, int instant,
                       const std::vector<ElasticFoundation>& beds, const ContactEffectValues& effects,
                       const EffectLoadQuery& query, EffectLoad& load);

/// Pressure and slip of every face of a region at one instant, with the effects: for pictures.
void ComputeFaceLoads(const EffectKinematics& kinematics, const EffectRegion& region, int instant,
                      const ElasticFoundation& bed, const ContactEffectValues& effects,
                      std::vector<FaceLoad>& loads);

/// A strip of springs in front of a region (towards +x of its mesh) or behind it, as wide and at the same
/// height.
/// @param length [m]; @param strips along x and z. Errors: none for a region with springs.
Result<ContactRegion> EdgeRegion(const ContactRegion& sole, bool toe, double length,
                                 const std::array<int, 2>& strips);

}  // namespace sinew
