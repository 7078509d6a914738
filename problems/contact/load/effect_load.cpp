#include "problems/contact/load/effect_load.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "problems/contact/load/bed_under_sole.h"
#include "problems/contact/load/floor_under_sole.h"
#include "problems/contact/load/spring_force.h"

namespace sinew {
namespace {

constexpr double kGravity = 9.80665;  // [m/s2]

// Sums over the springs of the derivatives of their load (Sum: a number or a ContactLoad) for their
// displacement upwards and its rate, times the arm of each mode.
template <class Sum>
struct ByShape {
  std::array<Sum, kShapeModes> by_up;
  std::array<Sum, kShapeModes> by_up_rate;

  explicit ByShape(const Sum& zero) {
    by_up.fill(zero);
    by_up_rate.fill(zero);
  }
  void Add(const RaisedFace& face, const Sum& by_rise, const Sum& by_rate) {
    for (std::size_t m = 0; m < kShapeModes; ++m) {
      by_up[m] -= face.arms[m] * by_rise;
      by_up_rate[m] -= face.arms[m] * by_rate;
    }
  }
  // @param add (effect, derivative for it)
  template <class Adder>
  void ForEach(const PhaseShare& share, const Adder& add) const {
    for (std::size_t m = 0; m < kShapeModes; ++m) {
      for (std::size_t j = 0; j < kShapePhases; ++j)
        add(ShapeEffect(m, j), Sum(share.value[j] * by_up[m] + share.rate[j] * by_up_rate[m]));
    }
  }
};

// The vertical force alone and, if wanted, its derivatives: a tenth of the work. What it computes it computes
// as AddRegion does, operation by operation, so that the answer is the same to the last bit.
// @tparam kShaped the sole is displaced, or the derivatives for that are wanted. @tparam kSloped the same of
// the floor's slope
template <bool kDerivatives, bool kShaped, bool kSloped>
void AddVertical(const FloorUnderSole& floor, const EffectRegion& region, int instant,
                 const BedUnderSole& bed, bool by_exponent, ContactLoad& load, ContactLoadJacobian& by_bed,
                 ContactEffectJacobian& by_effect) {
  const ContactKinematics& k = region.kinematics;
  const double up = floor.up();
  const auto t = static_cast<std::size_t>(instant);
  const std::array<double, 2> slip_by_rise{-region.turning_z[t], region.turning_x[t]};
  const double rate_by_rise = (floor.slope(0) * slip_by_rise[0] + floor.slope(1) * slip_by_rise[1]) * up;
  double force = load[kForceY];
  double by_stiffness = by_bed(kForceY, 0);
  double by_dissipation = by_bed(kForceY, 1);
  double for_exponent = by_effect(kForceY, kStiffnessExponent);
  double by_compliance = by_effect(kForceY, kFloorCompliance);
  double by_damping = by_effect(kForceY, kLinearDamping);
  double by_height = by_effect(kForceY, kHeightOffset);
  std::array<double, 2> for_slope{by_effect(kForceY, kFloorSlopeX), by_effect(kForceY, kFloorSlopeZ)};
  ByShape<double> for_shape(0);
  const auto first = t * static_cast<std::size_t>(k.faces);
  for (std::size_t f = 0; f < static_cast<std::size_t>(k.faces); ++f) {
    RaisedFace face = floor.DepthAt<kShaped>(region, first + f, f);
    if (!(face.depth > 0)) continue;
    floor.AddMotion<kShaped, kSloped>(region, instant, first + f, face);
    const Pressure p = bed.At(f, face.depth, face.rate, kDerivatives && by_exponent);
    if (!(p.value > 0)) continue;
    const double area = k.area[f];
    const double normal = area * p.value;
    force += normal * up;
    if constexpr (!kDerivatives) continue;
    by_stiffness += area * p.by_stiffness * up;
    by_dissipation += area * p.by_dissipation * up;
    for_exponent += area * p.by_exponent * up;
    by_compliance += area * p.by_compliance * up;
    by_damping += area * p.by_damping * up;
    bed.ForEachMode(f, area * p.by_stiffness * up, [&](std::size_t effect, double slope) {
      by_effect(kForceY, static_cast<Eigen::Index>(effect)) += slope;
    });
    const double by_rise = area * (p.by_depth * up + p.by_rate * rate_by_rise) * up;
    by_height += by_rise;
    if constexpr (kShaped) for_shape.Add(face, by_rise, (area * p.by_rate * up) * up);
    if constexpr (kSloped) {
      for (const std::size_t axis : {0U, 1U}) {
        const double shrink = floor.slope(axis) * up * up;  // -(dN/dslope) / N
        const double by_tilt = area * (-p.by_depth * face.depth * shrink +
                                       p.by_rate * (face.velocity[axis] * up - face.rate * shrink));
        for_slope[axis] += face.lever[axis] * by_rise + by_tilt * up + normal * (-shrink * up);
      }
    }
  }
  load[kForceY] = force;
  if constexpr (!kDerivatives) return;
  by_bed(kForceY, 0) = by_stiffness;
  by_bed(kForceY, 1) = by_dissipation;
  by_effect(kForceY, kStiffnessExponent) = for_exponent;
  by_effect(kForceY, kFloorCompliance) = by_compliance;
  by_effect(kForceY, kLinearDamping) = by_damping;
  by_effect(kForceY, kHeightOffset) = by_height;
  by_effect(kForceY, kFloorSlopeX) = for_slope[0];
  by_effect(kForceY, kFloorSlopeZ) = for_slope[1];
  if constexpr (!kShaped) return;
  for_shape.ForEach(floor.phase(), [&](std::size_t effect, double slope) {
    by_effect(kForceY, static_cast<Eigen::Index>(effect)) += slope;
  });
}

// AddVertical with what these values and this query need.
void AddVerticalOf(const EffectKinematics& kinematics, const EffectRegion& region, int instant,
                   const ElasticFoundation& of_region, const ContactEffectValues& effects,
                   const EffectLoadQuery& query, ContactLoad& load, ContactLoadJacobian& by_bed,
                   ContactEffectJacobian& by_effect) {
  const FloorUnderSole floor(kinematics, effects, instant);
  if (!floor.CanTouch(region, instant)) return;
  const BedUnderSole bed(of_region, region, effects);
  const bool derivatives = query.derivatives;
  const bool shaped = floor.displaced() || (derivatives && query.wants_shape());
  const bool sloped =
      floor.sloped() || (derivatives && (query.wants(kFloorSlopeX) || query.wants(kFloorSlopeZ)));
  const auto add = [&](const auto& add_vertical) {
    add_vertical(floor, region, instant, bed, query.wants(kStiffnessExponent), load, by_bed, by_effect);
  };
  if (derivatives) {
    if (shaped && sloped) return add(AddVertical<true, true, true>);
    if (shaped) return add(AddVertical<true, true, false>);
    if (sloped) return add(AddVertical<true, false, true>);
    return add(AddVertical<true, false, false>);
  }
  if (shaped && sloped) return add(AddVertical<false, true, true>);
  if (shaped) return add(AddVertical<false, true, false>);
  if (sloped) return add(AddVertical<false, false, true>);
  return add(AddVertical<false, false, false>);
}

// Adds one region's load and, if wanted, derivatives, as if its weight were 1. `by_spring` is nullptr or set.
void AddRegion(const EffectKinematics& kinematics, const EffectRegion& region, int instant,
               const ElasticFoundation& of_region, const ContactEffectValues& effects,
               const EffectLoadQuery& query, ContactLoad& load, ContactLoadJacobian& by_bed,
               ContactEffectJacobian& by_effect, SlipResponse& by_slip,
               std::vector<SpringGradient>* by_spring) {
  const ContactKinematics& k = region.kinematics;
  const FloorUnderSole floor(kinematics, effects, instant, query.shear_velocity);
  const bool derivatives = query.derivatives;
  const BedUnderSole bed(of_region, region, effects);
  const double up = floor.up();
  const std::array<double, 3> mu{of_region.static_friction, of_region.dynamic_friction,
                                 of_region.viscous_friction};
  const auto t = static_cast<std::size_t>(instant);
  const std::array<double, 2> slip_by_rise{-region.turning_z[t], region.turning_x[t]};
  const double rate_by_rise = (floor.slope(0) * slip_by_rise[0] + floor.slope(1) * slip_by_rise[1]) * up;
  ByShape<ContactLoad> by_shape(ContactLoad::Zero());
  const auto first = t * static_cast<std::size_t>(k.faces);
  for (std::size_t f = 0; f < static_cast<std::size_t>(k.faces); ++f) {
    if (by_spring != nullptr) (*by_spring)[f].setZero();
    RaisedFace face = floor.DepthAt<true>(region, first + f, f);
    if (!(face.depth > 0)) continue;
    floor.AddMotion<true, true>(region, instant, first + f, face);
    const Pressure p = bed.At(f, face.depth, face.rate, derivatives);
    if (!(p.value > 0)) continue;
    const double area = k.area[f];
    const double normal = area * p.value;
    const Lever lever{k.point_x[first + f], k.point_z[first + f]};

    const double slip = std::hypot(face.slip_x, face.slip_z);
    const FrictionPerSlip friction = FrictionPerSlipAt(slip, kinematics.transition_velocity);
    double drag = 0;  // friction per unit of normal force and of slip
    double drag_slope = 0;
    for (std::size_t j = 0; j < 3; ++j) {
      drag += mu[j] * friction.value[j];
      drag_slope += mu[j] * friction.slope[j];
    }
    const ContactLoad unit =
        lever.Of(-floor.slope(0) * up - drag * face.slip_x, up, -floor.slope(1) * up - drag * face.slip_z);
    load += normal * unit;
    if (!derivatives && !query.slip) continue;
    const auto by_slip_along = [&](double along_x, double along_z) -> ContactLoad {
      const double along = face.slip_x * along_x + face.slip_z * along_z;
      return lever.Of(-drag * along_x - drag_slope * along * face.slip_x, 0,
                      -drag * along_z - drag_slope * along * face.slip_z);
    };
    const ContactLoad by_slip_x = normal * by_slip_along(1, 0);
    const ContactLoad by_slip_z = normal * by_slip_along(0, 1);
    by_slip.jacobian.col(0) += by_slip_x;
    by_slip.jacobian.col(1) += by_slip_z;
    if (query.slip) {
      by_slip.potential +=
          normal *
          (FrictionPotentialAt(slip, kinematics.transition_velocity, mu) +
           (floor.slope(0) * query.shear_velocity[0] + floor.slope(1) * query.shear_velocity[1]) * up);
    }
    if (!derivatives) continue;

    by_bed.col(0) += area * p.by_stiffness * unit;
    by_bed.col(1) += area * p.by_dissipation * unit;
    for (std::size_t j = 0; j < 3; ++j) {
      by_bed.col(2 + static_cast<Eigen::Index>(j)) +=
          normal * lever.Of(-friction.value[j] * face.slip_x, 0, -friction.value[j] * face.slip_z);
    }
    by_effect.col(kStiffnessExponent) += area * p.by_exponent * unit;
    by_effect.col(kFloorCompliance) += area * p.by_compliance * unit;
    by_effect.col(kLinearDamping) += area * p.by_damping * unit;
    bed.ForEachMode(f, ContactLoad(area * p.by_stiffness * unit),
                    [&](std::size_t effect, const ContactLoad& slope) {
                      by_effect.col(static_cast<Eigen::Index>(effect)) += slope;
                    });

    // The floor rises: the spring gets deeper, and the sole's velocity is taken elsewhere.
    const ContactLoad by_rise = area * (p.by_depth * up + p.by_rate * rate_by_rise) * unit +
                                normal * by_slip_along(slip_by_rise[0], slip_by_rise[1]);
    by_effect.col(kHeightOffset) += by_rise;
    by_shape.Add(face, by_rise, (area * p.by_rate * up) * unit);
    for (const std::size_t axis : {0U, 1U}) {
      const double shrink = floor.slope(axis) * up * up;  // -(dN/dslope) / N
      const double by_tilt = area * (-p.by_depth * face.depth * shrink +
                                     p.by_rate * (face.velocity[axis] * up - face.rate * shrink));
      const ContactLoad turned = lever.Of((floor.slope(0) * shrink - (axis == 0 ? 1 : 0)) * up, -shrink * up,
                                          (floor.slope(1) * shrink - (axis == 1 ? 1 : 0)) * up);
      by_effect.col(static_cast<Eigen::Index>(kFloorSlopeX + axis)) +=
          face.lever[axis] * by_rise + by_tilt * unit + normal * turned;
    }
    if (by_spring == nullptr) continue;

    // The place and the motion of the spring itself.
    SpringGradient& gradient = (*by_spring)[f];
    const double force_x = normal * unit[kForceX];
    const double force_z = normal * unit[kForceZ];
    const ContactLoad by_rate = (area * p.by_rate * up) * unit;
    gradient.col(kDepth) = (area * p.by_depth * up) * unit;
    gradient.col(kRate) = by_rate;
    gradient.col(kSlipX) = by_slip_x + floor.slope(0) * by_rate;
    gradient.col(kSlipZ) = by_slip_z + floor.slope(1) * by_rate;
    gradient.col(kTurningX) = face.rise * gradient.col(kSlipZ);
    gradient.col(kTurningZ) = -face.rise * gradient.col(kSlipX);
    gradient.col(kPointX) = floor.slope(0) * by_rise;
    gradient(kMomentY, kPointX) -= force_z;
    gradient(kFirstMomentX, kPointX) += normal * up;
    gradient.col(kPointZ) = floor.slope(1) * by_rise;
    gradient(kMomentY, kPointZ) += force_x;
    gradient(kFirstMomentZ, kPointZ) += normal * up;
  }
  if (!derivatives) return;
  by_shape.ForEach(floor.phase(), [&](std::size_t effect, const ContactLoad& slope) {
    by_effect.col(static_cast<Eigen::Index>(effect)) += slope;
  });
}

}  // namespace

void ComputeEffectLoad(const EffectKinematics& kinematics, int instant,
                       const std::vector<ElasticFoundation>& beds, const ContactEffectValues& effects,
                       const EffectLoadQuery& query, EffectLoad& load) {
  std::size_t next = 0;  // of by_spring
  const auto add = [&](const EffectRegion& region, ContactLoad& sum, ContactLoadJacobian& by_bed,
                       ContactEffectJacobian& by_effect, SlipResponse& by_slip) {
    const ElasticFoundation& bed = beds[static_cast<std::size_t>(region.part)];
    if (query.vertical_only) {
      AddVerticalOf(kinematics, region, instant, bed, effects, query, sum, by_bed, by_effect);
    } else {
      AddRegion(kinematics, region, instant, bed, effects, query, sum, by_bed, by_effect, by_slip,
                query.springs ? &load.by_spring[next++] : nullptr);
    }
  };
  load.load.setZero();
  load.by_effect.setZero();
  load.by_slip = {};
  for (ContactLoadJacobian& jacobian : load.by_part) jacobian.setZero();
  for (const EffectRegion& region : kinematics.regions) {
    add(region, load.load, load.by_part[static_cast<std::size_t>(region.part)], load.by_effect, load.by_slip);
  }
  for (std::size_t edge = 0; edge < kinematics.edges.size(); ++edge) {
    const std::size_t effect = kToeRegion + edge;
    const double weight = effects[effect];
    if (weight == 0 && !query.edges) {
      if (query.springs) {
        for (SpringGradient& gradient : load.by_spring[next++]) gradient.setZero();
      }
      continue;
    }
    for (const EffectRegion& region : kinematics.edges[edge]) {
      const auto part = static_cast<std::size_t>(region.part);
      ContactLoad whole = ContactLoad::Zero();
      ContactLoadJacobian by_bed = ContactLoadJacobian::Zero();
      ContactEffectJacobian by_effect = ContactEffectJacobian::Zero();
      SlipResponse by_slip;
      add(region, whole, by_bed, by_effect, by_slip);
      load.load += weight * whole;
      load.by_part[part] += weight * by_bed;
      load.by_effect += weight * by_effect;
      load.by_slip.jacobian += weight * by_slip.jacobian;
      load.by_slip.potential += weight * by_slip.potential;
      load.by_effect.col(static_cast<Eigen::Index>(effect)) += whole;
      if (!query.springs) continue;
      for (SpringGradient& gradient : load.by_spring[next - 1]) gradient *= weight;
    }
  }
  load.of_springs = load.load;
  // A plate measures the load on it: the mass counts while a spring is compressed.
  if (!(load.load[kForceY] > 0)) return;
  const auto t = static_cast<std::size_t>(instant);
  const Vec3& a = kinematics.foot_acceleration[t];
  const Lever lever{kinematics.foot_position[t].x(), kinematics.foot_position[t].z()};
  const ContactLoad per_mass = lever.Of(a.x(), kGravity + a.y(), a.z());
  load.load += effects[kUnmodelledMass] * per_mass;
  load.by_effect.col(kUnmodelledMass) = per_mass;
}

void ComputeFaceLoads(const EffectKinematics& kinematics, const EffectRegion& region, int instant,
                      const ElasticFoundation& of_region, const ContactEffectValues& effects,
                      std::vector<FaceLoad>& loads) {
  const FloorUnderSole floor(kinematics, effects, instant);
  const BedUnderSole bed(of_region, region, effects);
  const auto faces = static_cast<std::size_t>(region.kinematics.faces);
  loads.assign(faces, {});
  for (std::size_t f = 0; f < faces; ++f) {
    const std::size_t i = static_cast<std::size_t>(instant) * faces + f;
    RaisedFace face = floor.DepthAt<true>(region, i, f);
    floor.AddMotion<true, true>(region, instant, i, face);
    loads[f] = {bed.At(f, face.depth, face.rate, false).value, std::hypot(face.slip_x, face.slip_z)};
  }
}

Result<ContactRegion> EdgeRegion(const ContactRegion& sole, bool toe, double length,
                                 const std::array<int, 2>& strips) {
  constexpr double kFar = std::numeric_limits<double>::infinity();
  Vec3 low(kFar, kFar, kFar);
  Vec3 high = -low;
  for (const int face : sole.SpringFaceIndices()) {
    for (const int corner : sole.mesh.faces[static_cast<std::size_t>(face)]) {
      const Vec3& vertex = sole.mesh.vertices[static_cast<std::size_t>(corner)];
      low = low.cwiseMin(vertex);
      high = high.cwiseMax(vertex);
    }
  }
  ContactRegion edge;
  edge.name = sole.name + (toe ? " toe edge" : " heel edge");
  constexpr double kThickness = 0.02;  // [m] of its closed mesh; only the bottom has springs
  SINEW_ASSIGN(edge.mesh, BoxMesh({length, kThickness, high.z() - low.z()}, strips[0], strips[1]));
  edge.springs = SpringFaces::kBottom;
  edge.rotation = sole.rotation;
  const double x = toe ? high.x() + 0.5 * length : low.x() - 0.5 * length;
  edge.position = sole.position + sole.rotation * Vec3(x, low.y(), 0.5 * (low.z() + high.z()));
  return edge;
}

}  // namespace sinew
