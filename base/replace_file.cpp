#include "base/replace_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <climits>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <filesystem>

#include "base/held_file.h"

namespace sinew {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kTemporaryNameBytes = 42;  // with the slash before it
constexpr int kMostLinks = 40;                   // as the kernel
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
int WriteAll(int file, std::string_view bytes) {
  const FileSizeSignalBlock block;
  while (!bytes.empty()) {
    const ssize_t written = write(file, bytes.data(), std::min(bytes.size(), kMaxBytesAtOnce));
    if (written < 0 && errno != EINTR) return errno;
    if (written > 0) bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  return 0;
}

// @return 0, or errno. A file system that cannot do it (EINVAL, ENOTSUP) has nothing to be brought to a disk.
int Synchronise(int file) {
  while (fsync(file) != 0) {
    if (errno == EINVAL || errno == ENOTSUP) return 0;
    if (errno != EINTR) return errno;
  }
  return 0;
}

int SynchroniseFolder(const std::string& folder) {
  const int file = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (file < 0) return 0;  // may be written to, but not be read
  const int failure = Synchronise(file);
  close(file);
  return failure;
}

// The new file takes over what the old one has. The owner only where that is allowed: it is then no loss that
// can be avoided.
int TakeOverPermissions(const std::string& target, int file) {
  struct stat old_file {};
  struct stat new_file {};
  if (stat(target.c_str(), &old_file) != 0 || fstat(file, &new_file) != 0) return 0;
  const bool other_owner = old_file.st_uid != new_file.st_uid || old_file.st_gid != new_file.st_gid;
  if (other_owner && fchown(file, old_file.st_uid, old_file.st_gid) != 0) errno = 0;
  const mode_t mode = old_file.st_mode & mode_t{07777};
  return mode == (new_file.st_mode & mode_t{07777}) || fchmod(file, mode) == 0 ? 0 : errno;
}

std::string FolderOf(const std::string& path) {
  const fs::path parent = fs::path(path).parent_path();
  return parent.empty() ? "." : parent.string();
}

Status CannotBeWritten(const std::string& path, int failure) {
  return Fail("{}: cannot be written: {}", path, std::strerror(failure));
}

// @return true if there is certainly none: file systems without a fixed size announce 0 of 0.
bool HasNoRoom(const std::string& folder) {
  struct statvfs disk {};
  if (statvfs(folder.c_str(), &disk) != 0) return false;
  const bool root = geteuid() == 0;
  const auto blocks = root ? disk.f_bfree : disk.f_bavail;
  const auto files = root ? disk.f_ffree : disk.f_favail;
  return (disk.f_blocks > 0 && blocks == 0) || (disk.f_files > 0 && files == 0);
}

Status CheckFolder(const std::string& path, const std::string& folder) {
  std::error_code code;
  if (!fs::is_directory(folder, code))
    return Fail("{}: cannot be written: there is no folder '{}'", path, folder);
  if (access(folder.c_str(), W_OK | X_OK) == 0) return {};
  if (errno == EACCES)
    return Fail("{}: cannot be written: no permission to write to the folder '{}'", path, folder);
  return CannotBeWritten(path, errno);
}

}  // namespace

Result<std::string> ResolveLinks(const std::string& path) {
  fs::path target = path;
  std::error_code code;
  for (int i = 0; fs::is_symlink(fs::symlink_status(target, code)); ++i) {
    if (i == kMostLinks) return Fail("{}: symbolic links that lead in a circle, expected a file", path);
    const fs::path next = fs::read_symlink(target, code);
    if (code) break;
    target = next.is_absolute() ? next : target.parent_path() / next;
  }
  return target.string();
}

Status CheckReplaceable(const std::string& path) {
  SINEW_ASSIGN(const std::string target, ResolveLinks(path));
  std::error_code code;
  const fs::file_status status = fs::status(target, code);
  if (fs::is_directory(status)) return Fail("{}: is a folder, expected a file to write", path);
  if (fs::exists(status) && !fs::is_regular_file(status))
    return Fail("{}: is a device, a pipe or a socket, expected a regular file to write", path);
  const std::string name = fs::path(target).filename().string();
  if (name.empty()) return Fail("{}: expected the name of a file to write", path);
  const std::string folder = FolderOf(target);
  if (target.size() >= PATH_MAX || folder.size() + kTemporaryNameBytes >= PATH_MAX)
    return Fail("{}: cannot be written: its path is too long, expected at most {} bytes", path,
                PATH_MAX - 1 - kTemporaryNameBytes);
  SINEW_TRY(CheckFolder(path, folder));
  const long longest = pathconf(folder.c_str(), _PC_NAME_MAX);
  if (longest > 0 && name.size() > static_cast<std::size_t>(longest))
    return Fail("{}: its name is too long, expected at most {} bytes", path, longest);
  if (fs::exists(status) && access(target.c_str(), W_OK) != 0) {
    if (errno == EACCES) return Fail("{}: is write-protected, expected a file that may be replaced", path);
    return CannotBeWritten(path, errno);
  }
  if (HasNoRoom(folder)) return CannotBeWritten(path, ENOSPC);
  return {};
}

Status ReplaceFile(const std::string& path, std::string_view bytes) {
  SINEW_TRY(CheckReplaceable(path));
  SINEW_ASSIGN(const std::string target, ResolveLinks(path));
  const std::string folder = FolderOf(target);
  RemoveAbandonedFiles(folder);
  HeldFile file;
  int failure = MakeTemporaryFile(folder, file);
  if (failure == 0) failure = WriteAll(file.descriptor(), bytes);
  if (failure == 0) failure = TakeOverPermissions(target, file.descriptor());
  if (failure == 0) failure = Synchronise(file.descriptor());
  if (failure == 0 && std::rename(file.path().c_str(), target.c_str()) != 0) failure = errno;
  if (failure != 0) return CannotBeWritten(path, failure);
  file.Keep();
  failure = SynchroniseFolder(folder);
  if (failure == 0) return {};
  return Fail(
      "{}: is written, but its folder could not be brought to the disk ({}): after a power failure the old "
      "file may be there again",
      path, std::strerror(failure));
}

}  // namespace sinew
