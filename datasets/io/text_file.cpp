#include "datasets/io/text_file.h"

#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace sinew {
namespace {

bool StartsWith(std::string_view text, std::string_view start) {
  return text.substr(0, start.size()) == start;
}

}  // namespace

Result<std::string> ReadTextFile(const std::string& path) {
  std::error_code code;
  if (!std::filesystem::exists(path, code)) return Fail("{}: no such file", path);
  if (std::filesystem::is_directory(path, code)) return Fail("{}: is a folder, expected a file", path);
  std::ifstream file(path, std::ios::binary);
  std::ostringstream buffer;
  if (!file) return Fail("{}: cannot be opened (no permission?)", path);
  if (file.peek() != std::ifstream::traits_type::eof()) buffer << file.rdbuf();
  if (file.bad() || buffer.fail()) return Fail("{}: cannot be read", path);

  std::string text = buffer.str();
  if (text.empty()) return Fail("{}: is empty", path);
  if (StartsWith(text, "\xFF\xFE") || StartsWith(text, "\xFE\xFF")) {
    return Fail("{}: is UTF-16 text, expected UTF-8; save it as plain or UTF-8 text", path);
  }
  if (StartsWith(text, "\xEF\xBB\xBF")) text.erase(0, 3);
  return text;
}

Status WriteTextFile(const std::string& path, std::string_view text) {
  const std::string beside = path + "." + std::to_string(getpid()) + ".tmp";
  std::ofstream file(beside, std::ios::binary);
  if (!file) return Fail("{}: cannot be written (does its folder exist?)", path);
  file.write(text.data(), static_cast<std::streamsize>(text.size()));
  file.close();
  if (!file || std::rename(beside.c_str(), path.c_str()) != 0) {
    std::remove(beside.c_str());
    return Fail("{}: cannot be written (disk full, or no permission)", path);
  }
  return {};
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
