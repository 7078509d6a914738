// What all targets have in common.
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "tests/fuzz/targets.h"

namespace sinew::fuzz {
namespace {

namespace fs = std::filesystem;

struct Folder {
  Folder() {
    std::error_code code;
    path = (fs::temp_directory_path() / ("sinew-fuzz-" + std::to_string(getpid()))).string();
    fs::create_directories(path, code);
  }
  ~Folder() {
    std::error_code code;
    fs::remove_all(path, code);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  std::string path;
};

}  // namespace

std::vector<std::string> Parts(std::string_view bytes, std::size_t count) {
  std::vector<std::string> parts;
  while (parts.size() + 1 < count) {
    const auto at = bytes.find(kSeparator);
    parts.emplace_back(bytes.substr(0, at));
    bytes = at == std::string_view::npos ? std::string_view() : bytes.substr(at + kSeparator.size());
  }
  parts.emplace_back(bytes);
  return parts;
}

void Demand(bool condition, const char* what) {
  if (condition) return;
  std::fprintf(stderr, "fuzz: %s\n", what);
  std::abort();
}

void DemandSentence(const Error& error, const std::string& place) {
  const std::string& message = error.message;
  if (message.size() > place.size() && message.compare(0, place.size(), place) == 0 && message.back() != '\n')
    return;
  std::fprintf(stderr, "fuzz: no sentence about %s: \"%s\"\n", place.c_str(), message.c_str());
  std::abort();
}

const std::string& ScratchFolder() {
  static const Folder kFolder;
  return kFolder.path;
}

std::string Scratch(const std::string& name, std::string_view bytes) {
  std::string path = ScratchFolder() + "/" + name;
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  file.close();
  if (!file) {
    std::fprintf(stderr, "fuzz: %s cannot be written\n", path.c_str());
    std::exit(1);
  }
  return path;
}

}  // namespace sinew::fuzz
