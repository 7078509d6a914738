#include "datasets/io/csv_file.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/text.h"
#include "base/value_limits.h"
#include "datasets/io/cells.h"
#include "datasets/io/text_file.h"

namespace sinew {
namespace {

// The separator that occurs most outside quotes; a comma if there is none.
char FindSeparator(std::string_view header) {
  constexpr std::string_view kSeparators = ",;\t";
  std::size_t counts[3] = {0, 0, 0};
  bool quoted = false;
  for (const char c : header) {
    if (c == '"') quoted = !quoted;
    const auto which = kSeparators.find(c);
    if (!quoted && which != std::string_view::npos) ++counts[which];
  }
  return kSeparators[static_cast<std::size_t>(std::max_element(counts, counts + 3) - counts)];
}

// Cells of one line without their quotes, trimmed; nothing if a quote is not closed.
std::optional<std::vector<std::string>> SplitCells(std::string_view line, char separator) {
  std::vector<std::string> cells;
  std::string cell;
  bool quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (quoted && c == '"' && i + 1 < line.size() && line[i + 1] == '"') {
      cell += '"';
      ++i;
    } else if (c == '"') {
      quoted = !quoted;
    } else if (c == separator && !quoted) {
      cells.emplace_back(Trim(cell));
      cell.clear();
    } else {
      cell += c;
    }
  }
  if (quoted) return std::nullopt;
  cells.emplace_back(Trim(cell));
  return cells;
}

class CsvParser {
 public:
  CsvParser(std::string_view text, const std::string& file) : lines_(text), file_(file) {}

  Result<CsvTable> Parse() {
    SINEW_TRY(ParseHeader());
    std::string_view line;
    while (NextWithContent(line)) SINEW_TRY(ParseRow(line));
    if (table_.lines.empty()) return Fail("{}: has no rows of data", file_);
    return std::move(table_);
  }

 private:
  bool NextWithContent(std::string_view& line) {
    while (lines_.Next(line)) {
      const std::string_view content = Trim(line);
      if (!content.empty() && content.front() != '#') return true;
    }
    return false;
  }

  Result<std::vector<std::string>> Cells(std::string_view line) const {
    auto cells = SplitCells(line, separator_);
    if (!cells) return FailAt(file_, lines_.number(), "a double quote is not closed");
    return std::move(*cells);
  }

  Status ParseHeader() {
    std::string_view line;
    if (!NextWithContent(line))
      return Fail("{}: is empty, expected a line with the names of the columns", file_);
    separator_ = FindSeparator(line);
    SINEW_ASSIGN(const auto names, Cells(line));
    if (std::all_of(names.begin(), names.end(),
                    [](const auto& name) { return ParseNumber(name).has_value(); })) {
      return FailAt(file_, lines_.number(), "holds numbers, expected the names of the columns");
    }
    if (names.size() > kMostColumns)
      return FailAt(file_, lines_.number(), "names {} columns, expected at most {}", names.size(),
                    kMostColumns);
    for (const std::string& name : names) {
      CsvColumn column;
      column.name = name;
      table_.columns.push_back(std::move(column));
    }
    table_.header_line = lines_.number();
    return {};
  }

  Status ParseRow(std::string_view line) {
    SINEW_ASSIGN(auto cells, Cells(line));
    const std::size_t columns = table_.columns.size();
    if (cells.size() == columns + 1 && cells.back().empty()) cells.pop_back();
    if (cells.size() != columns) {
      return FailAt(file_, lines_.number(), "row has {} cells, the header (line {}) names {} columns",
                    cells.size(), table_.header_line, columns);
    }
    for (std::size_t i = 0; i < columns; ++i) AddCell(cells[i], table_.columns[i]);
    table_.lines.push_back(lines_.number());
    return {};
  }

  void AddCell(std::string& cell, CsvColumn& column) const {
    if (separator_ != ',') std::replace(cell.begin(), cell.end(), ',', '.');
    const auto number = ParseSample(cell);
    if (!number && !column.text) column.text = CsvColumn::Text{lines_.number(), cell};
    column.values.push_back(number.value_or(std::numeric_limits<double>::quiet_NaN()));
    if (number) column.decimals = std::max(column.decimals, DecimalPlaces(cell));
  }

  LineReader lines_;
  const std::string& file_;
  char separator_ = ',';
  CsvTable table_;
};

}  // namespace

Result<CsvTable> ParseCsv(std::string_view text, const std::string& file) {
  return CsvParser(text, file).Parse();
}

Result<CsvTable> ReadCsv(const std::string& path) {
  SINEW_ASSIGN(const std::string text, ReadTextFile(path));
  return ParseCsv(text, path);
}

}  // namespace sinew
