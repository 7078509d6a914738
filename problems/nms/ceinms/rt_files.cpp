#include "problems/nms/ceinms/rt_files.h"

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <vector>

#include "base/text.h"

namespace sinew {
namespace {

namespace fs = std::filesystem;

bool IsFile(const fs::path& path) {
  std::error_code code;  // a name that is too long or not permitted is no file
  return fs::exists(path, code) && !fs::is_directory(path, code);
}

}  // namespace

Result<std::string> FindCeinmsRtFile(const CeinmsRtName& name) {
  std::string slashes = name.written;
  std::replace(slashes.begin(), slashes.end(), '\\', '/');
  const fs::path written = fs::path(slashes).lexically_normal();
  if (IsFile(written)) return written.string();

  const fs::path folder = fs::path(name.calibration).parent_path();
  std::vector<std::string> beside;
  if (written.is_relative()) {
    std::error_code code;
    fs::path above = fs::absolute(name.calibration, code).lexically_normal().parent_path();
    if (IsFile(folder / written)) return (folder / written).lexically_normal().string();
    for (; !above.empty(); above = above.parent_path()) {
      if (IsFile(above / written)) return (above / written).lexically_normal().string();
      if (above == above.parent_path()) break;
    }
  }
  const std::vector<fs::path> parts(written.begin(), written.end());
  for (std::size_t first = 1; first + static_cast<std::size_t>(name.kept) <= parts.size(); ++first) {
    fs::path rest;
    for (std::size_t i = first; i < parts.size(); ++i) rest /= parts[i];
    if (IsFile(folder / rest)) return (folder / rest).lexically_normal().string();
    beside.push_back(rest.string());
  }
  return FailAt(
      name.calibration, name.line,
      "{} names '{}', which is not there: it was looked for from the working folder, from the folder "
      "of this file and those above it{}",
      name.element, name.written, beside.empty() ? "" : ", and beside this file as " + Join(beside, ", "));
}

}  // namespace sinew
