// Marker trajectories of motion capture: .trc.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "base/linear_algebra.h"

namespace sinew {

struct TrcMarker {
  std::string name;
  Matrix position;  ///< [N x 3, m, laboratory frame of the file], NaN in gaps
};

struct TrcFile {
  double data_rate_Hz = 0;
  std::vector<double> time;        ///< [N, s, strictly increasing]
  std::vector<TrcMarker> markers;  ///< in the order of the file
  std::vector<long> lines;         ///< [N] line of each frame in the file
  std::vector<std::string> notes;  ///< what was done to the times, and what the header has wrong
};

/// Reads a .trc with units m, cm or mm; blank cells are gaps. Times that were rounded are rebuilt from
/// DataRate and the frame numbers; `notes` says so, and that there are fewer frames than the header
/// announces, which are read as in OpenSim. Errors, with the line: no such file, not a .trc, more frames or
/// other counts than announced, an unknown unit, a marker that appears twice, text where a number belongs,
/// time that does not increase, no frames.
Result<TrcFile> ReadTrc(const std::string& path);

/// ReadTrc for a text in memory. @param file the name that errors and notes show.
Result<TrcFile> ParseTrc(std::string_view text, const std::string& file);

}  // namespace sinew
