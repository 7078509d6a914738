#include "base/file_lock.h"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>

#include "base/replace_file.h"

namespace sinew {
namespace {

namespace fs = std::filesystem;

std::string ThisProcess() {
  std::array<char, 256> machine{};
  gethostname(machine.data(), machine.size() - 1);
  return fmt::format("process {} on {}", getpid(), machine.data());
}

std::string ReadHolder(const std::string& path) {
  std::array<char, 512> text{};
  const int file = open(path.c_str(), O_RDONLY | O_NONBLOCK | O_NOFOLLOW | O_CLOEXEC);
  if (file < 0) return {};
  const ssize_t length = read(file, text.data(), text.size());
  close(file);
  return length > 0 ? std::string(text.data(), static_cast<std::size_t>(length)) : std::string();
}

}  // namespace

Result<FileLock> FileLock::Try(const std::string& path) {
  SINEW_ASSIGN(const std::string resolved, ResolveLinks(path));
  const fs::path target(resolved);
  const fs::path folder = target.parent_path().empty() ? fs::path(".") : target.parent_path();
  const std::string name = (folder / LockNameOf(target.filename().string())).string();
  RemoveAbandonedFiles(folder.string());
  FileLock lock;
  const int failure = HoldFile(name, lock.file_);
  if (failure == EWOULDBLOCK) {
    lock.holder_ = ReadHolder(name);
  } else if (failure == ENOTSUP) {
    lock.state_ = State::kUnsupported;
  } else if (failure != 0) {
    return Fail("{}: cannot be written: {}", path, std::strerror(failure));
  } else {
    lock.state_ = State::kHeld;
    const std::string self = ThisProcess();
    // Without room for it the lock is as good.
    if (ftruncate(lock.file_.descriptor(), 0) != 0 ||
        pwrite(lock.file_.descriptor(), self.data(), self.size(), 0) < 0)
      errno = 0;
  }
  return lock;
}

}  // namespace sinew
