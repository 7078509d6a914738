// OpenSim's and CEINMS's tables, .sto and .mot: a header in one of several dialects, then a column per
// signal.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"

namespace sinew {

/// A table as the file has it: nothing is renamed or converted.
struct Storage {
  std::string title;  ///< the name line of the header; empty if it has none
  std::optional<bool>
      in_degrees;            ///< as the header says, if it does; it concerns rotational coordinates only
  std::vector<double> time;  ///< [N, s, strictly increasing]
  std::vector<std::string> names;            ///< [M] of the columns after the time
  std::vector<std::vector<double>> columns;  ///< [M][N], NaN in gaps
  std::vector<long> lines;         ///< [N] line of each row in its file; empty for a table made in memory
  std::vector<std::string> notes;  ///< what was done to the times, and what the header has wrong

  /// The column of that name, or nullptr.
  [[nodiscard]] const std::vector<double>* Find(std::string_view name) const;
};

/// Reads .sto and .mot files of OpenSim 3 and 4 (version=, nRows=, nColumns=, inDegrees=), SIMM and CEINMS
/// (`datacolumns N`, `datarows N`, `range`), with tabs or blanks between the values.
///
/// Times that were rounded are rebuilt (see UsableTimes); `notes` says so. Counts in the header that differ
/// from the rows or the names of the columns do not count, as in OpenSim; `notes` says so. Errors, with the
/// line: no such file, no `endheader`, a row with more or fewer values than names, a first column that is not
/// time, a name that appears twice, text where a number belongs, time that does not increase, no rows.
Result<Storage> ReadStorage(const std::string& path);

/// ReadStorage for a text in memory. @param file the name that errors and notes show.
Result<Storage> ParseStorage(std::string_view text, const std::string& file);

/// Writes an OpenSim file (version 1) with every digit, in one step. Errors: sizes that differ, a folder that
/// cannot be written.
Status WriteStorage(const std::string& path, const Storage& storage);

}  // namespace sinew
