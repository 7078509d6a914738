// Forces of several trials as one record of the ground's loads on the feet.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "base/error.h"
#include "datasets/dataset.h"

namespace sinew {

/// A trial, and what it is called in what is said of it.
struct LoadSource {
  std::string name;
  std::string recording;  ///< whose times it has
  const Trial* trial = nullptr;
};

/// A time of one plate, and the source that decides about it.
struct LoadSpan {
  std::string plate;
  std::string source;
  double from = 0;  ///< [s]
  double to = 0;    ///< [s]
};

/// Of one plate: force x, y, z [N], centre of pressure x, y, z [m], moment x, y, z about it [N m]; y is up.
struct PlateLoad {
  std::string plate;
  std::array<std::vector<double>, 9> values;  ///< as many of each as there are instants
};

struct GroundLoads {
  std::vector<double> time;  ///< [s], equally spaced
  std::vector<PlateLoad> plates;
  std::vector<LoadSpan> spans;  ///< a source gives a load: of each plate in the order of time; none elsewhere
  std::vector<LoadSpan> gaps;   ///< a source has samples, but neither it nor another one a force: it is zero
};

/// Whether a trial has values of a plate's vertical force (PLATE_force_y).
[[nodiscard]] bool HoldsLoad(const Trial& trial);

/// Joins the plate channels of all sources. At each instant the load of a plate is that of the first source
/// in which its vertical force exceeds 2 % of its largest value in any; where it does so in none, that of the
/// first that has values; where none has, zero. Between samples it is interpolated linearly; a centre of
/// pressure that is not known is that of the nearest instant of the same source at which it is; cop_y and
/// moments that a source does not have are zero.
/// @param rate [Hz] of the result; 0: the greatest median rate of the sources
/// Errors: sources of more than one recording, whose times differ; no source holds a load; a source has a
/// plate's vertical force without force_x, force_z, cop_x or cop_z, or no known centre of pressure; more than
/// 20 million instants.
Result<GroundLoads> JoinGroundLoads(const std::vector<LoadSource>& sources, double rate);

}  // namespace sinew
