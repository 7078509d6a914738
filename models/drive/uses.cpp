#include "models/drive/uses.h"

#include <algorithm>
#include <cmath>

namespace sinew {
namespace {

// Dry friction, in the order of its slots.
constexpr std::array<int, 9> kFrictionLevels{kCoulombTorque,        kForwardFriction, kBackwardFriction,
                                             kStribeckTorque,       kLoadFriction,    kMotorLoadFriction,
                                             kExternalLoadFriction, kStribeckLoad,    kQuadraticLoad};

// Of an unknown term's curve [per unit of its signal]; 0 if there is no such term.
double SteepestSlope(DriveTerm term, const DriveNumbers& p, const DriveJoint& joint) {
  const auto& knots = joint.knots[term];
  double most = 0;
  for (std::size_t k = 0; k + 1 < knots.size(); ++k) {
    const auto slot = static_cast<std::size_t>(kTermSlots[term]) + k;
    most = std::max(most, std::abs(p[slot + 1] - p[slot]) / (knots[k + 1] - knots[k]));
  }
  return most;
}

}  // namespace

DriveUses UsesOf(const DriveNumbers& numbers, const std::array<bool, kDriveSlots>& differentiated,
                 const DriveJoint& joint) {
  DriveUses uses;
  for (int slot = 0; slot < kDriveSlots; ++slot) {
    const auto at = static_cast<std::size_t>(slot);
    const double null = slot == kInputGain ? 1 : 0;
    uses.slot[at] = numbers[at] != null || differentiated[at];
  }
  for (int term = 0; term < kTerms; ++term) {
    if (joint.knots[static_cast<std::size_t>(term)].empty()) continue;
    const auto t = static_cast<std::size_t>(term);
    uses.term[t] = std::any_of(uses.slot.data() + kTermSlots[t], uses.slot.data() + kTermSlots[t + 1],
                               [](bool b) { return b; });
  }
  uses.dry_friction = uses.unknown_friction() || std::any_of(kFrictionLevels.begin(), kFrictionLevels.end(),
                                                             [&](int slot) { return uses[slot]; });
  uses.input_sensor = uses[kInputOffset] || uses[kInputGain] || uses[kInputDrift] || uses[kInputLowPass];
  return uses;
}

bool AnyFrictionAboveZero(const DriveNumbers& numbers) {
  const auto is_above_zero = [&](int slot) { return numbers[static_cast<std::size_t>(slot)] > 0; };
  if (std::any_of(kFrictionLevels.begin(), kFrictionLevels.end(), is_above_zero)) return true;
  for (int slot = kTermSlots[kFrictionOfPosition]; slot < kTermSlots[kFrictionOfTime + 1]; ++slot) {
    if (is_above_zero(slot)) return true;
  }
  return false;
}

double FastestRate(const DriveNumbers& p, const DriveJoint& joint, const DriveCommand& command,
                   const DriveRun& run) {
  const double mass = p[kInertia] + joint.load_inertia + p[kInertiaError];
  double damping = p[kViscousFriction];
  if (p[kFrictionTemperature] != 0) {
    double most = 0;
    for (const double kelvin : run.signals[kTemperature].values)
      most = std::max(most, p[kFrictionTemperature] * (kelvin - kReferenceTemperature));
    damping *= std::exp(most);
  }
  damping += std::abs(p[kViscousAsymmetry]);
  double stiffness = std::abs(p[kGravityTorque]) + joint.load_gravity + std::abs(p[kImbalance]) +
                     std::abs(p[kSpring]) +
                     3 * std::abs(p[kCubicStiffness]) * joint.largest_position * joint.largest_position +
                     (std::abs(p[kCoggingCos]) + std::abs(p[kCoggingSin])) * 6.3 / p[kCoggingPeriod];
  double volts = 1;
  if (joint.electric) {
    volts = joint.gear_ratio * p[kTorqueConstant] / p[kResistance];
    volts /= 1 + std::min(0.0, p[kResistanceRate]) * run.stops.back();
    damping += volts * joint.gear_ratio * p[kTorqueConstant];
  }
  if (command.controller == DriveControllerKind::kServo) {
    const auto& voltage = run.signals[kSupplyVoltage].values;
    const double supply = *std::max_element(voltage.begin(), voltage.end());
    const double gain = volts * supply * run.gains.servo_error_gain * run.gains.kp / p[kInputGain];
    stiffness += gain;
    damping += gain * (p[kSensingDelay] + p[kActuationDelay]);
  }
  // Falling dry friction, and the fading torque near the highest speed.
  if (p[kStribeckTorque] > 0) damping += p[kStribeckTorque] / p[kStribeckVelocity];
  const double load = std::abs(p[kGravityTorque]) + joint.load_gravity;
  if (p[kStribeckLoad] > 0) damping += p[kStribeckLoad] * load / p[kStribeckLoadVelocity];
  damping += 2 * p[kDrag] * joint.largest_speed;
  damping += joint.largest_torque * p[kInverseSpeedLimit] / DriveDynamics<double>::kSpeedFade;
  stiffness = std::max(
      {stiffness, SteepestSlope(kTorqueOfPosition, p, joint), SteepestSlope(kFrictionOfPosition, p, joint)});
  double most = 0;
  for (int slot = kTermSlots[kDampingOfTime]; slot < kTermSlots[kDampingOfTime + 1]; ++slot)
    most = std::max(most, p[static_cast<std::size_t>(slot)]);
  damping = std::max(damping + most, SteepestSlope(kTorqueOfVelocity, p, joint));
  return damping / mass + std::sqrt(stiffness / mass);
}

}  // namespace sinew
