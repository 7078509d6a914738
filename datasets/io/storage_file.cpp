#include "datasets/io/storage_file.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>

#include "base/printable.h"
#include "base/replace_file.h"
#include "base/text.h"
#include "base/value_limits.h"
#include "datasets/io/cells.h"
#include "datasets/io/sample_times.h"
#include "datasets/io/text_file.h"

namespace sinew {
namespace {

// A count that the header announces, and where.
struct DeclaredCount {
  long count = 0;
  long line = 0;
};

struct Header {
  std::string title;
  std::optional<DeclaredCount> rows;
  std::optional<DeclaredCount> columns;
  std::optional<bool> in_degrees;
};

// "nRows=151", "nRows = 151", "datarows 151" -> {"nrows", "151"}; the value is empty where there is none.
struct KeyValue {
  std::string key;
  std::string_view value;
};

KeyValue SplitHeaderLine(std::string_view line) {
  const auto separator = line.find_first_of("= \t");
  if (separator == std::string_view::npos) return {Lowercase(line), {}};
  std::string_view value = Trim(line.substr(separator));
  if (!value.empty() && value.front() == '=') value = Trim(value.substr(1));
  return {Lowercase(Trim(line.substr(0, separator))), value};
}

class StorageParser {
 public:
  StorageParser(std::string_view text, const std::string& file) : lines_(text), file_(file) {}

  Result<Storage> Parse() {
    SINEW_TRY(ParseHeader());
    SINEW_TRY(ParseNames());
    SINEW_TRY(ParseRows());
    SINEW_ASSIGN(storage_.time, UsableTimes(file_, printed_, storage_.notes));
    storage_.title = header_.title;
    storage_.in_degrees = header_.in_degrees;
    storage_.lines = std::move(printed_.lines);
    return std::move(storage_);
  }

 private:
  Status ParseHeader() {
    std::string_view line;
    bool first = true;
    while (lines_.Next(line)) {
      line = Trim(line);
      if (Lowercase(line.substr(0, 9)) == "endheader") return {};
      if (line.empty() || line.front() == '#' || line.substr(0, 2) == "//") continue;
      SINEW_TRY(ParseHeaderLine(line, first));
      first = false;
    }
    return Fail("{}: has no line 'endheader'; expected a .sto or .mot file", file_);
  }

  // Lines that mean nothing to us (version, range, remarks) are passed over: programs write what they like
  // here.
  Status ParseHeaderLine(std::string_view line, bool first) {
    const auto [key, value] = SplitHeaderLine(line);
    if (key == "nrows" || key == "datarows") return ReadCount(key, value, header_.rows);
    if (key == "ncolumns" || key == "datacolumns") return ReadCount(key, value, header_.columns);
    if (key == "indegrees") return ReadInDegrees(value);
    if (key == "datatype") {
      if (Lowercase(value) == "double") return {};
      return FailAt(file_, lines_.number(), "DataType {} is not supported, expected double", Quoted(value));
    }
    if (key == "name") {
      header_.title = value;
    } else if (first && line.find('=') == std::string_view::npos) {
      header_.title = line;
    }
    return {};
  }

  Status ReadCount(const std::string& key, std::string_view value, std::optional<DeclaredCount>& announced) {
    const auto count = ParseInteger(value);
    if (!count || *count < 0) {
      return FailAt(file_, lines_.number(), "{} is {}, expected a whole number", key, Quoted(value));
    }
    announced = DeclaredCount{*count, lines_.number()};
    return {};
  }

  Status ReadInDegrees(std::string_view value) {
    const std::string word = Lowercase(value);
    if (word != "yes" && word != "no" && word != "true" && word != "false") {
      return FailAt(file_, lines_.number(), "inDegrees is {}, expected yes or no", Quoted(value));
    }
    header_.in_degrees = word == "yes" || word == "true";
    return {};
  }

  bool NextWithContent(std::string_view& line) {
    while (lines_.Next(line)) {
      if (!Trim(line).empty()) return true;
    }
    return false;
  }

  Status ParseNames() {
    std::string_view line;
    if (!NextWithContent(line))
      return Fail("{}: ends after its header, expected the names of the columns", file_);
    line = Trim(line);
    std::vector<std::string_view> names = SplitNames(line);
    if (names.size() > kMostColumns)
      return FailAt(file_, lines_.number(), "names {} columns, expected at most {}", names.size(),
                    kMostColumns);
    if (!MatchesHeader(names.size())) {
      Note(fmt::format("{} column names, the header announces {} columns (line {}); all of them were read",
                       names.size(), header_.columns->count, header_.columns->line));
    }
    std::set<std::string> seen;
    for (const std::string_view name : names) {
      const std::string trimmed(Trim(name));
      if (!seen.insert(trimmed).second) {
        return FailAt(file_, lines_.number(), "the column name {} appears twice", Quoted(trimmed));
      }
      storage_.names.push_back(trimmed);
    }
    if (Lowercase(storage_.names.front()) != "time") {
      return FailAt(file_, lines_.number(), "the first column is {}, expected time",
                    Quoted(storage_.names.front()));
    }
    storage_.names.erase(storage_.names.begin());
    storage_.columns.resize(storage_.names.size());
    return {};
  }

  // Between tabs a name may hold blanks; runs of tabs and blanks are taken as one separator where that does
  // not fit.
  [[nodiscard]] std::vector<std::string_view> SplitNames(std::string_view line) const {
    std::vector<std::string_view> names = Split(line, '\t');
    const bool all_named =
        std::none_of(names.begin(), names.end(), [](std::string_view name) { return Trim(name).empty(); });
    const bool by_tabs = names.size() > 1 && all_named;
    if (by_tabs && MatchesHeader(names.size())) return names;
    std::vector<std::string_view> words = SplitBlanks(line);
    return by_tabs && !MatchesHeader(words.size()) ? names : words;
  }

  void Note(const std::string& what) {
    storage_.notes.push_back(fmt::format("{}:{}: {}", file_, lines_.number(), what));
  }

  [[nodiscard]] bool MatchesHeader(std::size_t columns) const {
    return !header_.columns || static_cast<long>(columns) == header_.columns->count;
  }

  Status ParseRows() {
    int decimals = 0;
    std::string_view line;
    while (NextWithContent(line)) {
      SINEW_ASSIGN(const auto cells, SplitRow(line));
      SINEW_TRY(ParseRow(cells));
      decimals = std::max(decimals, DecimalPlaces(cells.front()));
    }
    if (RowCount() == 0) return Fail("{}: has no rows of data", file_);
    if (header_.rows && RowCount() != header_.rows->count) {
      Note(fmt::format(
          "the file ends after {} rows, the header announces {} rows (line {}); all of them were read",
          RowCount(), header_.rows->count, header_.rows->line));
    }
    constexpr int kMaxDecimals = 12;  // more digits than that: computed times, not rounded ones
    if (decimals <= kMaxDecimals) printed_.last_digit_s = std::pow(10.0, -decimals);
    return {};
  }

  [[nodiscard]] long RowCount() const { return static_cast<long>(printed_.time_s.size()); }

  // Runs of tabs and blanks separate values; only a row that then lacks some is taken as cells between single
  // tabs, of which empty ones are gaps.
  Result<std::vector<std::string_view>> SplitRow(std::string_view line) const {
    const std::size_t columns = storage_.names.size() + 1;
    std::vector<std::string_view> values = SplitBlanks(line);
    if (values.size() == columns) return values;
    std::vector<std::string_view> cells = Split(line, '\t');
    while (cells.size() > columns && Trim(cells.back()).empty()) cells.pop_back();
    if (values.size() < columns && cells.size() == columns) return cells;
    if (header_.columns && MatchesHeader(columns)) {
      return FailAt(file_, lines_.number(), "row has {} values, the header announces {} columns",
                    values.size(), columns);
    }
    return FailAt(file_, lines_.number(), "row has {} values, but {} columns have a name", values.size(),
                  columns);
  }

  Status ParseRow(const std::vector<std::string_view>& cells) {
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const auto number = ParseSample(cells[i]);
      if (!number) {
        return FailAt(file_, lines_.number(), "column '{}': {} is not a number",
                      i == 0 ? "time" : storage_.names[i - 1], Quoted(cells[i]));
      }
      (i == 0 ? printed_.time_s : storage_.columns[i - 1]).push_back(*number);
    }
    printed_.lines.push_back(lines_.number());
    return {};
  }

  LineReader lines_;
  const std::string& file_;
  Header header_;
  Storage storage_;
  PrintedTimes printed_;
};

}  // namespace

const std::vector<double>* Storage::Find(std::string_view name) const {
  const auto found = std::find(names.begin(), names.end(), name);
  return found == names.end() ? nullptr : &columns[static_cast<std::size_t>(found - names.begin())];
}

Result<Storage> ParseStorage(std::string_view text, const std::string& file) {
  return StorageParser(text, file).Parse();
}

Result<Storage> ReadStorage(const std::string& path) {
  SINEW_ASSIGN(const std::string text, ReadTextFile(path));
  return ParseStorage(text, path);
}

Status WriteStorage(const std::string& path, const Storage& storage) {
  if (storage.columns.size() != storage.names.size()) {
    return Fail("{}: {} names for {} columns", path, storage.names.size(), storage.columns.size());
  }
  for (std::size_t i = 0; i < storage.columns.size(); ++i) {
    if (storage.columns[i].size() != storage.time.size()) {
      return Fail("{}: column '{}' has {} values, its time has {}", path, storage.names[i],
                  storage.columns[i].size(), storage.time.size());
    }
  }
  fmt::memory_buffer text;
  auto out = std::back_inserter(text);
  fmt::format_to(out, "{}\nversion=1\nnRows={}\nnColumns={}\ninDegrees={}\nendheader\ntime",
                 storage.title.empty() ? "sinew" : PrintableLine(storage.title), storage.time.size(),
                 storage.names.size() + 1, storage.in_degrees.value_or(false) ? "yes" : "no");
  for (const std::string& name : storage.names) fmt::format_to(out, "\t{}", PrintableLine(name));
  for (std::size_t row = 0; row < storage.time.size(); ++row) {
    fmt::format_to(out, "\n{}", storage.time[row]);
    for (const auto& column : storage.columns) fmt::format_to(out, "\t{}", column[row]);
  }
  fmt::format_to(out, "\n");
  return ReplaceFile(path, std::string_view(text.data(), text.size()));
}

}  // namespace sinew
