// The laboratory's own simulation of a person on a dynamometer. It shares no equation of the boundary and no
// integrator with the fitted model: forces are found in the frame of the shank on a finer sole, fibres move
// at the velocity at which their force is the tendon's, the motor's torque moves the plate, and everything is
// integrated by the classical Runge-Kutta method in steps of 0.1 ms.
#pragma once

#include <functional>
#include <vector>

#include "base/error.h"
#include "models/dynamometer/strapped_foot.h"
#include "problems/ankle_on_dynamometer/laboratory/machine_program.h"

namespace sinew {

/// What the laboratory knows at one instant.
struct LaboratoryInstant {
  double time = 0;                    ///< since the trial began [s]
  double plate_angle = 0;             ///< [rad]
  double plate_velocity = 0;          ///< [rad/s]
  double ankle_angle = 0;             ///< [rad]
  double ankle_velocity = 0;          ///< [rad/s]
  double motor_torque = 0;            ///< of the motor on the attachment [N m]
  double interaction = 0;             ///< torque of the foot on the plate [N m]
  double sole_normal = 0;             ///< [N]
  double strap = 0;                   ///< [N]
  double muscle_power = 0;            ///< [W]
  double lost_power = 0;              ///< friction, damping [W]
  double energy = 0;                  ///< kinetic, of gravity and of all springs [J]
  std::vector<double> fibre_lengths;  ///< [m]
};

struct LaboratoryTrial {
  MachineProgram program;
  bool foot = true;     ///< false: the attachment alone
  double duration = 8;  ///< [s]
  /// Activations [muscles] at a time since the begin.
  std::function<void(double since, std::vector<double>& activations)> activation;
};

/// Calls see(instant) every `apart` [s], a multiple of the step, from 0 on.
/// Errors: no equilibrium at the begin; a state that is not finite.
Status SimulateLaboratory(const FootGeometry& geometry, const MuscleCurves& curves,
                          const std::vector<MusclePath>& paths, const StrappedFoot<double>& truth,
                          const LaboratoryTrial& trial, double apart,
                          const std::function<void(const LaboratoryInstant&)>& see);

}  // namespace sinew
