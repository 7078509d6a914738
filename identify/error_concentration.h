// Errors concentrated in one short stretch of a trial: an event that no model contains, such as a foot on the
// wrong plate.
#pragma once

#include <string>
#include <vector>

#include "base/linear_algebra.h"
#include "identify/layout.h"
#include "identify/warning.h"

namespace sinew {

/// A stretch of a twentieth of a block's samples that holds more than a quarter of its squared errors, and
/// more than twice as much as any stretch that does not overlap it. The second condition excludes errors that
/// recur, as those of every stride do.
struct Concentration {
  std::string trial;
  std::string channel;
  double time = 0;   ///< [s] middle of the stretch
  double width = 0;  ///< [s]
  double share = 0;  ///< of the block's squared errors
  /// The stretch is the end of the trial, and squared errors grow from each quarter of it to the next: the
  /// prediction drifts, as an open loop does, and the measurement is not to blame.
  bool drift = false;
  std::vector<Concentration> others;  ///< those of other blocks that are told with it
};

/// The concentrations of all blocks with at least 200 measured samples: those that drifts explain as one, and
/// all others as one, each with the largest share first and the rest in `others`.
/// @param values [layout size][predictions] predicted values
[[nodiscard]] std::vector<Concentration> FindConcentrations(const Layout& layout,
                                                            const std::vector<Vector>& values);

/// As a warning of an identification or a diagnosis: kErrorConcentration, or kErrorDrift.
[[nodiscard]] Warning ToWarning(const Concentration& concentration);

}  // namespace sinew
