#include "problems/contact/load/sheared_load.h"

namespace sinew {
namespace {

Horizontal ForceOf(const EffectLoad& load) {
  return {load.of_springs[kForceX], load.of_springs[kForceZ]};
}

HorizontalJacobian BySlip(const EffectLoad& load) {
  HorizontalJacobian by_slip;
  by_slip << load.by_slip.jacobian.row(kForceX), load.by_slip.jacobian.row(kForceZ);
  return by_slip;
}

}  // namespace

bool FindShearVelocity(const EffectKinematics& kinematics, int instant,
                       const std::vector<ElasticFoundation>& beds, const ContactEffectValues& effects,
                       const SoleShear& shear, EffectLoad& load, std::array<double, 2>& shear_velocity) {
  shear_velocity = {};
  if (shear.compliance() == 0) return true;
  EffectLoadQuery query;
  query.derivatives = false;
  query.slip = true;
  Horizontal velocity;
  const bool found = shear.Solve(
      [&](const Horizontal& at) -> SoleShear::Friction {
        query.shear_velocity = {at.x(), at.y()};
        ComputeEffectLoad(kinematics, instant, beds, effects, query, load);
        return {ForceOf(load), BySlip(load), load.by_slip.potential};
      },
      velocity);
  shear_velocity = {velocity.x(), velocity.y()};
  return found;
}

void AcceptShear(const std::array<double, 2>& shear_velocity, SoleShear& shear, EffectLoad& load) {
  const Horizontal force = ForceOf(load);
  load.by_effect.col(kShearCompliance) = load.by_slip.jacobian * shear.ForceRate(force);
  shear.Accept({shear_velocity[0], shear_velocity[1]}, force, BySlip(load));
}

}  // namespace sinew
