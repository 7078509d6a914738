// Sample times as files print them: often rounded so far that the steps alternate.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/error.h"

namespace sinew {

/// The time column of a file.
struct PrintedTimes {
  std::vector<double> time_s;  ///< [N, s]
  std::vector<long> lines;     ///< [N] line of each sample in the file
  double last_digit_s = 0;     ///< one unit of the last printed decimal, in s; 0 if the times are not rounded
  std::optional<double> rate_Hz;   ///< what the file's header says, if it does
  std::vector<long> sample_index;  ///< [N] increasing, where the file counts its samples; empty: 0, 1, 2, ...
};

/// Times that rise strictly: those of the file, or, where they were rounded, those that were meant.
///
/// Steps that alternate (0.0017, 0.0033, 0.005) are rebuilt uniformly if every printed time lies within half
/// a unit of its last decimal of one uniform grid; where the header gives the rate, a whole unit is allowed
/// (some programs cut digits off). A note says so. A missing sample is no rounding: steps of less than two
/// units are rebuilt only if both lengths occur often. Errors: a time that is not a number, or does not
/// increase (the message gives its line and both values).
Result<std::vector<double>> UsableTimes(const std::string& file, const PrintedTimes& printed,
                                        std::vector<std::string>& notes);

}  // namespace sinew
