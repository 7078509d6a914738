// An integrated mechanism: the path of its point, and the quantities that should be conserved.
#pragma once

#include <string>
#include <vector>

#include "base/error.h"
#include "base/linear_algebra.h"
#include "models/mechanisms/mechanism.h"

namespace sinew {

struct MechanismOptions {
  std::string formulation;  ///< empty: the mechanism's first
  std::string integrator;   ///< empty: the first of IntegratorRegistry
  double accuracy = 1e-9;   ///< relative error per unit time and step, 1e-14 .. 0.1; of the constraints too
  int windows = 40;         ///< of A02, 1 .. 1000
  double longest_seconds = 600;  ///< of CPU time, > 0
};

struct MechanismRun {
  Matrix values;              ///< [samples x coordinates]
  double energy_drift = 0;    ///< largest |energy - energy at 0 - work done| [J]
  double kinetic_energy = 0;  ///< largest [J]
  double position_violation =
      0;  ///< largest constraint error, in the constraint's own unit; 0: no constraints
  double velocity_violation = 0;
  double seconds = 0;  ///< CPU time of the integration
  long steps = 0;
  long evaluations = 0;  ///< of the accelerations
};

/// Errors: no such formulation or integrator, an accuracy or a time out of range.
[[nodiscard]] Status CheckMechanismOptions(const Mechanism& mechanism, const MechanismOptions& options);

/// @param times [samples] s, from 0 on, increasing. Errors: no such formulation or integrator, an accuracy
/// out of range, Simbody's own (step size, projection) as a sentence, the limit of CPU time is reached.
[[nodiscard]] Result<MechanismRun> SimulateMechanism(const Mechanism& mechanism,
                                                     const MechanismOptions& options,
                                                     const std::vector<double>& times);

}  // namespace sinew
