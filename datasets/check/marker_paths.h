// Channels NAME_x, NAME_y, NAME_z as points.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "base/linear_algebra.h"
#include "datasets/check/signals.h"

namespace sinew {

/// A point whose three coordinates are measured.
struct Marker {
  std::string name;
  std::array<const Signal*, 3> axes{};
  /// Place in its set of the marker on the other side of the body; its own, if its name has no side; -1 if
  /// there is none.
  int mirror = -1;

  [[nodiscard]] const std::string& trial() const { return axes[0]->trial; }
  [[nodiscard]] const std::vector<double>& time() const { return *axes[0]->time; }
  [[nodiscard]] std::size_t size() const { return axes[0]->size(); }
};

using Path = std::vector<Vec3>;  ///< [frames, m] NaN in gaps

[[nodiscard]] Path PathOf(const Marker& marker);

/// The markers of each grid of each trial, in the order of their names: all points in metres but centres of
/// pressure.
[[nodiscard]] std::vector<std::vector<Marker>> MarkerSets(const std::vector<ChannelGroup>& groups);

}  // namespace sinew
