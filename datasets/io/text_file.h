// Text files: read whole, taken apart into numbered lines.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"

namespace sinew {

/// The text of a file without a byte-order mark. Errors: those of ReadFile, empty, UTF-16.
Result<std::string> ReadTextFile(const std::string& path);

/// "" or the byte-order mark of UTF-8 that ReadTextFile leaves out, to be written back with the text.
[[nodiscard]] std::string ByteOrderMarkOf(const std::string& path);

/// The names of the files that this thread asks ReadTextFile for while the object lives: files that name
/// other files, as a CEINMS setup does, are read in many places, and none of them may be overwritten by what
/// is made of them.
class TextFilesRead {
 public:
  TextFilesRead();
  ~TextFilesRead();
  TextFilesRead(const TextFilesRead&) = delete;
  TextFilesRead& operator=(const TextFilesRead&) = delete;

  [[nodiscard]] const std::vector<std::string>& paths() const { return paths_; }

 private:
  friend Result<std::string> ReadTextFile(const std::string& path);
  void Remember(const std::string& path);

  TextFilesRead* outer_;
  std::vector<std::string> paths_;
};

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
