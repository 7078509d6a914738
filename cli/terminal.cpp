#include "cli/terminal.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>

#include "base/numbers.h"
#include "base/printable.h"
#include "base/replace_file.h"
#include "base/text.h"

namespace sinew {
namespace {

constexpr double kTerminalInterval = 0.1;  // [s] between rewrites of the line
constexpr double kPlainInterval = 5;       // [s] between lines of a log

}  // namespace

ProgressLine::ProgressLine(std::string title, bool quiet)
    : title_(std::move(title)),
      quiet_(quiet),
      on_terminal_(isatty(STDERR_FILENO) != 0),
      last_(std::chrono::steady_clock::now()) {}

bool ProgressLine::Due() {
  if (quiet_) return false;
  const auto now = std::chrono::steady_clock::now();
  if (std::chrono::duration<double>(now - last_).count() <
      (on_terminal_ ? kTerminalInterval : kPlainInterval))
    return false;
  last_ = now;
  return true;
}

void ProgressLine::Print(const std::string& line) {
  if (on_terminal_) {
    std::fprintf(stderr, "\r\033[K%s", PrintableLine(line).c_str());
    shown_ = true;
  } else {
    std::fprintf(stderr, "%s\n", PrintableLine(line).c_str());
  }
}

void ProgressLine::Show(const Progress& progress, const Budget& budget) {
  if (!Due()) return;
  std::string line = fmt::format("{}: {} evaluations, best cost {}, {}", title_, progress.evaluations,
                                 Readable(progress.best_cost, 5), Duration(progress.seconds));
  double left = budget.max_seconds - progress.seconds;
  if (progress.evaluations > 0 && budget.max_evaluations < std::numeric_limits<long>::max()) {
    const auto remaining = static_cast<double>(budget.max_evaluations - progress.evaluations);
    left = std::min(left, remaining * progress.seconds / static_cast<double>(progress.evaluations));
  }
  if (std::isfinite(left)) line += fmt::format(", at most {} left", Duration(std::max(0.0, left)));
  Print(line);
}

void ProgressLine::Show(int done, int all) {
  if (Due()) Print(fmt::format("{}: {} of {}", title_, done, all));
}

void ProgressLine::Show(const std::string& step) {
  if (Due()) Print(fmt::format("{}: {}", title_, step));
}

void ProgressLine::Clear() {
  if (shown_) std::fprintf(stderr, "\r\033[K");
  shown_ = false;
}

std::string Duration(double seconds) {
  if (seconds < 1e-3) return fmt::format("{:.0f} us", seconds * 1e6);
  if (seconds < 1) return fmt::format("{:.3g} ms", seconds * 1e3);
  if (seconds < 60) return fmt::format("{:.3g} s", seconds);
  return fmt::format("{:.0f} min {:.0f} s", std::floor(seconds / 60), std::fmod(seconds, 60));
}

std::string Wrapped(const std::string& sentence, int indent, int width) {
  const std::string margin(static_cast<std::size_t>(indent), ' ');
  std::string text;
  std::string line = margin;
  const std::string printable = PrintableLine(sentence);
  for (const auto word : SplitBlanks(printable)) {
    const bool first = line.size() == margin.size();
    if (!first && line.size() + 1 + word.size() > static_cast<std::size_t>(width)) {
      text += line + "\n";
      line = margin + "  ";
    } else if (!first) {
      line += ' ';
    }
    line += word;
  }
  return text + line + "\n";
}

std::string Table(std::vector<std::vector<std::string>> rows, int indent) {
  std::vector<std::size_t> widths;
  for (auto& row : rows) {
    for (std::string& cell : row) cell = PrintableLine(cell);
    widths.resize(std::max(widths.size(), row.size()), 0);
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
  }
  std::string text;
  for (const auto& row : rows) {
    std::string line(static_cast<std::size_t>(indent), ' ');
    for (std::size_t i = 0; i < row.size(); ++i) {
      line += row[i];
      if (i + 1 < row.size()) line.append(widths[i] - row[i].size() + 2, ' ');
    }
    text += line + "\n";
  }
  return text;
}

void Print(std::FILE* stream, const std::string& text) {
  std::fputs(Printable(text).c_str(), stream);
}

Status WriteText(const std::string& path, const std::string& text) {
  if (path != "-") return ReplaceFile(path, text + "\n");
  const bool written =
      std::fputs((PrintableJson(text) + "\n").c_str(), stdout) >= 0 && std::fflush(stdout) == 0;
  return written ? Status() : Fail("standard output cannot be written: {}", std::strerror(errno));
}

}  // namespace sinew
