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

/// The points of a marker, [frames, m], NaN in gaps; as they lie in the data set.
class Path {
 public:
  /// @param marker must outlive this
  explicit Path(const Marker& marker)
      : x_(marker.axes[0]->values), y_(marker.axes[1]->values), z_(marker.axes[2]->values) {}

  [[nodiscard]] std::size_t size() const { return x_.size(); }
  [[nodiscard]] Vec3 operator[](std::size_t i) const { return {x_[i], y_[i], z_[i]}; }

 private:
  const std::vector<double>& x_;
  const std::vector<double>& y_;
  const std::vector<double>& z_;
};

/// The markers of each grid of each trial, in the order of their names: all points in metres but centres of
/// pressure.
[[nodiscard]] std::vector<std::vector<Marker>> MarkerSets(const std::vector<ChannelGroup>& groups);

}  // namespace sinew
