#include "cli/command_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <thread>

#include "base/replace_file.h"
#include "cli/mpi_ranks.h"
#include "cli/terminal.h"

namespace sinew {
namespace {

namespace fs = std::filesystem;

constexpr std::chrono::milliseconds kRetryInterval{20};
constexpr std::chrono::milliseconds kPatience{
    2000};  // until somebody is told that the program waits, or ends

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

// Waits until the lock is there; if that takes a while, says for whom.
Result<FileLock> Claim(const std::string& path, IfBusy if_busy) {
  for (int tries = 0;; ++tries) {
    SINEW_ASSIGN(FileLock lock, FileLock::Try(path));
    if (lock.unsupported()) {
      Print(stderr,
            fmt::format(
                "warning: the file system of {} has no locks: another process that changes it meanwhile is "
                "not noticed\n",
                path));
    }
    if (lock.held() || lock.unsupported()) return lock;
    const std::string holder = lock.holder().empty() ? "another process" : lock.holder();
    // A process that was told to stop needs a moment to save what it has.
    if (if_busy == IfBusy::kRefuse && tries >= kPatience / kRetryInterval)
      return Fail("{}: is being written by {}; wait for it, or write another file", path, holder);
    if (tries == kPatience / kRetryInterval)
      Print(stderr, fmt::format("note: waiting for {}, which is changing {}\n", holder, path));
    std::this_thread::sleep_for(kRetryInterval);
  }
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
    SINEW_TRY(CheckReplaceable(written[i]));
  }
  return {};
}

Result<FileLocks> ClaimFiles(const CommandFiles& files, IfBusy if_busy) {
  if (IsHelper()) return FileLocks();  // writes nothing
  SINEW_TRY(CheckFiles(files));
  std::vector<std::string> written = files.written;
  if (!files.json.empty() && files.json != "-") written.push_back(files.json);
  for (std::string& path : written) {
    SINEW_ASSIGN(path, ResolveLinks(path));
  }
  std::sort(written.begin(), written.end());  // in one order everywhere: no two processes wait for each other
  FileLocks locks;
  for (const std::string& path : written) {
    SINEW_ASSIGN(FileLock lock, Claim(path, if_busy));
    locks.push_back(std::move(lock));
  }
  return locks;
}

void NoteBeginning(const std::string& out) {
  Print(stderr, fmt::format("note: --resume: {} is not there yet, this begins from the start\n", out));
}

Result<FileLocks> ClaimInPlace(const std::string& data, const std::string& out,
                               const std::vector<std::string>& read, const std::string& json) {
  const bool in_place = out.empty() || IsSameFile(data, out);
  CommandFiles files{read, {out.empty() ? data : out}, json};
  if (in_place) {
    CommandFiles others{read, {}, json};
    others.read.push_back(data);
    SINEW_TRY(CheckFiles(others));
  } else {
    files.read.push_back(data);
  }
  return ClaimFiles(files);
}

}  // namespace sinew
