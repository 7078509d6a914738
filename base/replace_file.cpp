#include "base/replace_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <filesystem>

namespace sinew {
namespace {

namespace fs = std::filesystem;

// Linux writes at most 2 GiB at once.
constexpr std::size_t kMaxBytesAtOnce = std::size_t{1} << 30;

// Keeps SIGXFSZ, which by default ends a process whose file becomes larger than its limit, away from this
// thread: write() then fails with EFBIG like with any other error.
class FileSizeSignalBlock {
 public:
  FileSizeSignalBlock() {
    sigemptyset(&signal_);
    sigaddset(&signal_, SIGXFSZ);
    pthread_sigmask(SIG_BLOCK, &signal_, &before_);
  }
  ~FileSizeSignalBlock() {
    // The signal that waits is taken before it is let through again.
    const timespec at_once{};
    while (sigtimedwait(&signal_, nullptr, &at_once) > 0) {
    }
    pthread_sigmask(SIG_SETMASK, &before_, nullptr);
  }
  FileSizeSignalBlock(const FileSizeSignalBlock&) = delete;
  FileSizeSignalBlock& operator=(const FileSizeSignalBlock&) = delete;

 private:
  sigset_t signal_{};
  sigset_t before_{};
};

// @return 0, or errno of what failed.
int WriteAll(const std::string& path, std::string_view bytes) {
  const FileSizeSignalBlock block;
  const int file = open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (file < 0) return errno;
  int failure = 0;
  while (!bytes.empty() && failure == 0) {
    const ssize_t written = write(file, bytes.data(), std::min(bytes.size(), kMaxBytesAtOnce));
    if (written >= 0) {
      bytes.remove_prefix(static_cast<std::size_t>(written));
    } else if (errno != EINTR) {
      failure = errno;
    }
  }
  // Some file systems tell only now that there was no room.
  if (close(file) != 0 && errno != EINTR && failure == 0) failure = errno;
  return failure;
}

}  // namespace

Status CheckReplaceable(const std::string& path) {
  std::error_code code;
  const fs::file_status status = fs::status(path, code);
  if (fs::is_directory(status)) return Fail("{}: is a folder, expected a file to write", path);
  if (fs::exists(status) && !fs::is_regular_file(status))
    return Fail("{}: is a device, a pipe or a socket, expected a regular file to write", path);
  return {};
}

Status ReplaceFile(const std::string& path, std::string_view bytes) {
  SINEW_TRY(CheckReplaceable(path));
  std::error_code code;
  const fs::path resolved = fs::canonical(path, code);
  const std::string target = code ? path : resolved.string();
  const std::string beside = target + "." + std::to_string(getpid()) + ".tmp";
  int failure = WriteAll(beside, bytes);
  if (failure == 0 && std::rename(beside.c_str(), target.c_str()) != 0) failure = errno;
  if (failure == 0) return {};
  std::remove(beside.c_str());
  return Fail("{}: cannot be written: {}", path, std::strerror(failure));
}

}  // namespace sinew
