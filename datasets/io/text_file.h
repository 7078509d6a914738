// Text files: read whole, taken apart into numbered lines, replaced in one step.
#pragma once

#include <string>
#include <string_view>

#include "base/error.h"

namespace sinew {

/// The text of a file without a byte-order mark. Errors: no such file, a folder, not readable, empty, UTF-16.
Result<std::string> ReadTextFile(const std::string& path);

/// Writes beside the target and renames over it. Errors: the folder cannot be written; the old file then
/// still stands.
Status WriteTextFile(const std::string& path, std::string_view text);

/// Walks over the lines of a text; lines end with \n, \r\n or \r.
class LineReader {
 public:
  explicit LineReader(std::string_view text) : rest_(text) {}

  /// Puts the next line, without its end, into `line`; false after the last.
  bool Next(std::string_view& line);

  /// Number of the line that Next gave last; the first is 1.
  [[nodiscard]] long number() const { return number_; }

 private:
  std::string_view rest_;
  long number_ = 0;
};

}  // namespace sinew
