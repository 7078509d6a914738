#include "datasets/io/mat_path.h"

#include <cctype>

#include "base/text.h"

namespace sinew {
namespace {

class PathParser {
 public:
  explicit PathParser(std::string_view text) : text_(text) {}

  std::optional<MatPath> Parse() {
    MatPath path;
    path.variable = Name();
    if (path.variable.empty()) return std::nullopt;
    while (at_ < text_.size()) {
      auto step = Step();
      if (!step) return std::nullopt;
      step->written = std::string(text_.substr(0, at_));
      const bool ends = step->kind == MatStep::Kind::kColumn || step->kind == MatStep::Kind::kRow;
      path.steps.push_back(std::move(*step));
      if (ends && at_ < text_.size()) return std::nullopt;
    }
    return path;
  }

 private:
  bool Take(char c) {
    if (at_ >= text_.size() || text_[at_] != c) return false;
    ++at_;
    return true;
  }

  std::string Name() {
    const std::size_t begin = at_;
    const auto is_part = [&](char c) {
      const auto byte = static_cast<unsigned char>(c);
      return std::isalpha(byte) != 0 || (at_ > begin && (c == '_' || std::isdigit(byte) != 0));
    };
    while (at_ < text_.size() && is_part(text_[at_])) ++at_;
    return std::string(text_.substr(begin, at_ - begin));
  }

  std::optional<std::size_t> Index() {
    constexpr long kLargest = 1000000000;
    const std::size_t begin = at_;
    while (at_ < text_.size() && std::isdigit(static_cast<unsigned char>(text_[at_])) != 0) ++at_;
    const auto number = ParseInteger(text_.substr(begin, at_ - begin));
    if (!number || *number < 1 || *number > kLargest) return std::nullopt;
    return static_cast<std::size_t>(*number - 1);
  }

  std::optional<MatStep> Step() {
    MatStep step;
    if (Take('.')) {
      step.name = Name();
      if (step.name.empty()) return std::nullopt;
      return step;
    }
    step.kind = MatStep::Kind::kElement;
    if (Take('{')) return Indexed(std::move(step), '}');
    if (!Take('(')) return std::nullopt;
    if (Take(':')) {
      step.kind = MatStep::Kind::kColumn;
      if (!Take(',')) return std::nullopt;
    }
    return Indexed(std::move(step), ')');
  }

  std::optional<MatStep> Indexed(MatStep step, char closing) {
    const auto index = Index();
    if (!index) return std::nullopt;
    step.index = *index;
    if (closing == ')' && step.kind == MatStep::Kind::kElement && Take(',')) {
      step.kind = MatStep::Kind::kRow;
      if (!Take(':')) return std::nullopt;
    }
    if (!Take(closing)) return std::nullopt;
    return step;
  }

  std::string_view text_;
  std::size_t at_ = 0;
};

}  // namespace

std::optional<MatPath> ParseMatPath(std::string_view text) {
  std::string without_blanks;
  for (const char c : text) {
    if (c != ' ') without_blanks += c;
  }
  // "EMG TA" is a title, "data(:, 3)" a path.
  if (text.find(' ') < text.find('(')) return std::nullopt;
  return PathParser(without_blanks).Parse();
}

}  // namespace sinew
