#include "datasets/io/text_file.h"

#include "base/read_file.h"

namespace sinew {
namespace {

bool StartsWith(std::string_view text, std::string_view start) {
  return text.substr(0, start.size()) == start;
}

constexpr std::string_view kUtf8Mark = "\xEF\xBB\xBF";

thread_local TextFilesRead* innermost = nullptr;

}  // namespace

TextFilesRead::TextFilesRead() : outer_(innermost) {
  innermost = this;
}

TextFilesRead::~TextFilesRead() {
  innermost = outer_;
}

void TextFilesRead::Remember(const std::string& path) {
  paths_.push_back(path);
  if (outer_ != nullptr) outer_->Remember(path);
}

Result<std::string> ReadTextFile(const std::string& path) {
  if (innermost != nullptr) innermost->Remember(path);
  SINEW_ASSIGN(std::string text, ReadFile(path));
  if (text.empty()) return Fail("{}: is empty", path);
  if (StartsWith(text, "\xFF\xFE") || StartsWith(text, "\xFE\xFF")) {
    return Fail("{}: is UTF-16 text, expected UTF-8; save it as plain or UTF-8 text", path);
  }
  if (StartsWith(text, kUtf8Mark)) text.erase(0, kUtf8Mark.size());
  return text;
}

std::string ByteOrderMarkOf(const std::string& path) {
  const Result<std::string> text = ReadFile(path);
  return text && StartsWith(*text, kUtf8Mark) ? std::string(kUtf8Mark) : "";
}

bool LineReader::Next(std::string_view& line) {
  if (rest_.empty()) return false;
  const auto end = rest_.find_first_of("\r\n");
  line = rest_.substr(0, end);
  if (end == std::string_view::npos) {
    rest_ = {};
  } else {
    const bool two = rest_[end] == '\r' && end + 1 < rest_.size() && rest_[end + 1] == '\n';
    rest_.remove_prefix(end + (two ? 2 : 1));
  }
  ++number_;
  return true;
}

}  // namespace sinew
