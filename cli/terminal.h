// What the program prints while it works.
#pragma once

#include <chrono>
#include <cstdio>
#include <string>
#include <vector>

#include "identify/execution/evaluator.h"

namespace sinew {

/// Progress of a search on stderr: one line that is rewritten on a terminal, a plain line every few seconds
/// when redirected, nothing when quiet.
class ProgressLine {
 public:
  ProgressLine(std::string title, bool quiet);
  ~ProgressLine() { Clear(); }
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  void Show(const Progress& progress, const Budget& budget);
  /// Any other work: so many of so many done.
  void Show(int done, int all);
  /// Work without a count: what is done now.
  void Show(const std::string& step);
  void Clear();

 private:
  bool Due();
  void Print(const std::string& line);

  std::string title_;
  bool quiet_;
  bool on_terminal_;
  bool shown_ = false;
  std::chrono::steady_clock::time_point last_;
};

/// "3 ms", "1.2 s", "4 min 10 s".
[[nodiscard]] std::string Duration(double seconds);

/// Breaks a sentence over lines of at most `width`, each with the indent.
[[nodiscard]] std::string Wrapped(const std::string& sentence, int indent, int width = 110);

/// Columns padded to equal width; the first row is the header.
[[nodiscard]] std::string Table(std::vector<std::vector<std::string>> rows, int indent);

/// Everything that is printed goes through this or ProgressLine: what comes from files may hold control
/// characters.
void Print(std::FILE* stream, const std::string& text);

/// Writes text to a file, or JSON to standard output if the name is "-".
Status WriteText(const std::string& path, const std::string& text);

}  // namespace sinew
