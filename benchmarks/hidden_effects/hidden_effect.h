// The errors that can be hidden in a case: an effect or an outsider whose size is one number.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "base/random.h"
#include "problems/drive/laboratory/simulation.h"

namespace sinew {

/// Ranges of motion and torque in the training trials.
struct Extents {
  double position = 1;  ///< [rad] largest magnitude
  double speed = 1;     ///< [rad/s]
  double torque = 1;    ///< [N*m]
};

/// A hidden error with all values but its size.
struct HiddenEffect {
  std::string name;
  std::function<void(double amplitude, DriveTruth& truth)> apply;  ///< amplitude 0 is the null
  double guess = 0.01;                                             ///< a small amplitude
  double most = 1e3;                                               ///< largest meaningful amplitude
};

/// Names of the library's effects that the standard experiment can contain. Left out are effects that the
/// base parameters fully compensate (torque.gain) and that need a known controller or inertia (sensing_delay,
/// inertia_error).
[[nodiscard]] const std::vector<std::string>& LibraryEffects();
[[nodiscard]] const std::vector<std::string>& OutsiderNames();

/// Draws the other values besides the size: Stribeck velocity, cogging period and phase, ratios, signs. The
/// values are continuous, not the probe values of the diagnosis. @param name one of LibraryEffects or
/// OutsiderNames.
[[nodiscard]] HiddenEffect DrawHidden(const std::string& name, const Extents& extents, Random& random);

/// The columns of the library's effect without knowledge of the drawn values: groups of columns; an effect
/// with probe values has a group for each of them, one with several linear parameters has a column for each.
[[nodiscard]] std::vector<std::vector<HiddenEffect>> CandidateColumns(const std::string& name,
                                                                      const Extents& extents);

}  // namespace sinew
