// The load of a sole with contact effects that gives way horizontally (SoleShear).
#pragma once

#include <vector>

#include "problems/contact/load/effect_load.h"
#include "problems/contact/load/sole_shear.h"

namespace sinew {

/// The velocity of the springs at this instant, after SoleShear::Next: EffectLoadQuery::shear_velocity; zero
/// without a compliance. @param load scratch. @return false: none was found
[[nodiscard]] bool FindShearVelocity(const EffectKinematics& kinematics, int instant,
                                     const std::vector<ElasticFoundation>& beds,
                                     const ContactEffectValues& effects, const SoleShear& shear,
                                     EffectLoad& load, std::array<double, 2>& shear_velocity);

/// After ComputeEffectLoad with that velocity: ends the instant. Sets the derivative for kShearCompliance, at
/// a fixed rate of the force.
void AcceptShear(const std::array<double, 2>& shear_velocity, SoleShear& shear, EffectLoad& load);

}  // namespace sinew
