// The load of a foot as force and moment in the frame of the foot, so that steps can be compared.
#pragma once

#include <vector>

#include "problems/contact/stance.h"

namespace sinew {

/// Forward, up and to the outside of the foot.
constexpr std::size_t kAxes = 3;

using Wrench = Eigen::Matrix<double, 6, 1>;        ///< force [N], moment [N m]: forward, up, outward
using WrenchOfLoad = Eigen::Matrix<double, 6, 6>;  ///< [wrench, ContactLoad]

/// Turns a wrench in ground axes into the frame of a foot in the middle of its stance, mirrored for a left
/// one: forces along the direction of progression (feet that turn out by different angles carry the same
/// forces), moments, which say where under the foot they act, along the foot.
[[nodiscard]] WrenchOfLoad IntoFoot(const Stance& stance);

/// Force and moment about a place, in ground axes, of a foot's load. @param place [m] on the floor
[[nodiscard]] WrenchOfLoad WrenchAbout(const Vec3& place);

/// Wrenches over the share of a stance, or of one of its phases, that has passed.
struct WrenchCurve {
  std::vector<double> share;  ///< [N, 0..1, increasing]
  std::vector<Wrench> wrench;
  /// Linear between two of them, the end values beyond. Not of an empty one.
  [[nodiscard]] Wrench At(double at) const;
};

/// Whether the stance's foot is on the floor at an instant.
[[nodiscard]] bool IsLoaded(const Stance& stance, std::size_t instant);

}  // namespace sinew
