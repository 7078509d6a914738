// Tables of text with a row of column names: comma, semicolon or tab between the cells.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"

namespace sinew {

struct CsvColumn {
  /// The first cell of a column that holds text where a number was expected.
  struct Text {
    long line = 0;
    std::string cell;
  };

  std::string name;
  std::vector<double> values;  ///< [N] as written, NaN in gaps and where there is text
  int decimals = 0;            ///< most digits after the point that a cell shows
  std::optional<Text> text;    ///< if there is any; such a column can be passed over, but not be used
};

struct CsvTable {
  long header_line = 0;
  std::vector<CsvColumn> columns;
  std::vector<long> lines;  ///< [N] line of each row in the file
};

/// Reads a table. The first line that is neither blank nor a '#' comment names the columns and decides the
/// separator; cells may be in double quotes; an empty cell or NaN is a gap. Where the separator is not a
/// comma, a decimal comma is understood. Errors, with the line: no such file, no header, a row with another
/// number of cells than the header, a quote that is not closed, no rows.
Result<CsvTable> ReadCsv(const std::string& path);

/// ReadCsv for a text in memory. @param file the name that errors show.
Result<CsvTable> ParseCsv(std::string_view text, const std::string& file);

}  // namespace sinew
