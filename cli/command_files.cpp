#include "cli/command_files.h"

#include <unistd.h>

#include <filesystem>

#include "base/replace_file.h"

namespace sinew {
namespace {

namespace fs = std::filesystem;

// File systems take 255; beside the file it is written under a longer name first (ReplaceFile).
constexpr std::size_t kMaxNameBytes = 235;

bool IsSameFile(const std::string& a, const std::string& b) {
  std::error_code code;
  if (fs::equivalent(a, b, code)) return true;
  // One that does not exist yet has no identity but its path. A path that runs through what is no folder has
  // no canonical form, and is no file either.
  const fs::path path_a = fs::weakly_canonical(fs::absolute(a, code), code);
  if (code) return false;
  const fs::path path_b = fs::weakly_canonical(fs::absolute(b, code), code);
  return !code && path_a == path_b;
}

Status CheckWritable(const std::string& path) {
  SINEW_TRY(CheckReplaceable(path));
  if (fs::path(path).filename().string().size() > kMaxNameBytes)
    return Fail("{}: its name is too long, expected at most {} bytes", path, kMaxNameBytes);
  std::error_code code;
  const fs::path target = fs::canonical(path, code);  // what a link leads to is replaced where it is
  const fs::path parent = (code ? fs::path(path) : target).parent_path();
  const std::string folder = parent.empty() ? "." : parent.string();
  if (!fs::is_directory(folder, code))
    return Fail("{}: cannot be written: there is no folder '{}'", path, folder);
  if (access(folder.c_str(), W_OK) != 0)
    return Fail("{}: cannot be written: no permission to write to the folder '{}'", path, folder);
  return {};
}

}  // namespace

Status CheckFiles(const CommandFiles& files) {
  std::vector<std::string> written = files.written;
  for (const std::string& path : written) {
    if (path.empty()) return Fail("the name of a file to write is empty");
    if (path == "-") return Fail("-: expected the name of a file to write; standard output takes JSON only");
  }
  if (!files.json.empty() && files.json != "-") written.push_back(files.json);
  for (std::size_t i = 0; i < written.size(); ++i) {
    for (const std::string& input : files.read) {
      if (!input.empty() && IsSameFile(written[i], input))
        return Fail("{}: is read by this command, expected another file to write", written[i]);
    }
    for (std::size_t j = 0; j < i; ++j) {
      if (IsSameFile(written[i], written[j]))
        return Fail("{}: would be written twice by this command, expected different files", written[i]);
    }
    SINEW_TRY(CheckWritable(written[i]));
  }
  return {};
}

Status CheckInPlace(const std::string& data, const std::string& out, const std::vector<std::string>& read,
                    const std::string& json) {
  const bool in_place = out.empty() || IsSameFile(data, out);
  CommandFiles files{read, {out.empty() ? data : out}, in_place ? "" : json};
  if (!in_place) files.read.push_back(data);
  SINEW_TRY(CheckFiles(files));
  if (!in_place) return {};
  files.read.push_back(data);
  return CheckFiles({files.read, {}, json});
}

}  // namespace sinew
