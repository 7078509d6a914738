// What may be hidden in a case: an effect or an outsider whose size is one number.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "base/random.h"
#include "problems/drive/laboratory/simulation.h"

namespace sinew {

/// How far the joint moves and the drive pushes in the training trials.
struct Extents {
  double position = 1;  ///< [rad] largest magnitude
  double speed = 1;     ///< [rad/s]
  double torque = 1;    ///< [N*m]
};

/// Something hidden, all but its size being settled.
struct HiddenEffect {
  std::string name;
  std::function<void(double amplitude, DriveTruth& truth)> apply;  ///< amplitude 0 is the null
  double guess = 0.01;                                             ///< a small amplitude
  double most = 1e3;                                               ///< larger ones mean nothing
};

/// Names of the library's effects that the standard experiment can contain. Left out are what the base
/// parameters absorb without a trace (torque.gain) and what needs a known controller or inertia
/// (sensing_delay, inertia_error).
[[nodiscard]] const std::vector<std::string>& LibraryEffects();
[[nodiscard]] const std::vector<std::string>& OutsiderNames();

/// Draws what is left open besides the size: Stribeck velocity, cogging period and phase, ratios, signs. The
/// values are continuous, not those that the diagnosis probes. @param name one of LibraryEffects or
/// OutsiderNames.
[[nodiscard]] HiddenEffect DrawHidden(const std::string& name, const Extents& extents, Random& random);

/// The library's effect as somebody sees it who does not know what was drawn: groups of columns; an effect
/// with probe values has a group for each of them, one with several linear parameters has a column for each.
[[nodiscard]] std::vector<std::vector<HiddenEffect>> CandidateColumns(const std::string& name,
                                                                      const Extents& extents);

}  // namespace sinew
