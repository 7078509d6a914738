#include "base/read_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

namespace sinew {
namespace {

constexpr off_t kLargest = off_t{1} << 32;            // [bytes]
constexpr std::size_t kPiece = std::size_t{1} << 20;  // [bytes] read at once beyond the announced size

Result<off_t> SizeOf(int file, const std::string& path) {
  struct stat status {};
  if (fstat(file, &status) != 0) return Fail("{}: cannot be read: {}", path, std::strerror(errno));
  if (S_ISDIR(status.st_mode)) return Fail("{}: is a folder, expected a file", path);
  if (!S_ISREG(status.st_mode))
    return Fail("{}: is a device, a pipe or a socket, expected a regular file", path);
  return status.st_size;
}

Result<std::string> ReadOpen(int file, const std::string& path) {
  SINEW_ASSIGN(const off_t size, SizeOf(file, path));
  if (size > kLargest) return Fail("{}: has {} bytes, expected at most {}", path, size, kLargest);
  std::string bytes(static_cast<std::size_t>(size), '\0');
  std::size_t length = 0;
  while (true) {
    if (length == bytes.size()) bytes.resize(length + kPiece);  // it may grow meanwhile
    const ssize_t count = read(file, bytes.data() + length, std::min(bytes.size() - length, kPiece));
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return Fail("{}: cannot be read: {}", path, std::strerror(errno));
    if (count == 0) break;
    length += static_cast<std::size_t>(count);
    if (length > static_cast<std::size_t>(kLargest))
      return Fail("{}: grows while it is read, expected at most {} bytes", path, kLargest);
  }
  bytes.resize(length);
  return bytes;
}

Result<std::string> ReadStart(int file, const std::string& path, std::size_t most) {
  SINEW_TRY(SizeOf(file, path));
  std::string bytes(most, '\0');
  std::size_t length = 0;
  while (length < most) {
    const ssize_t count = read(file, bytes.data() + length, most - length);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return Fail("{}: cannot be read: {}", path, std::strerror(errno));
    if (count == 0) break;
    length += static_cast<std::size_t>(count);
  }
  bytes.resize(length);
  return bytes;
}

Result<int> Open(const std::string& path) {
  const int file = open(path.c_str(), O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
  if (file < 0 && (errno == ENOENT || errno == ENOTDIR)) return Fail("{}: no such file", path);
  if (file < 0 && errno == ENXIO)
    return Fail("{}: is a device, a pipe or a socket, expected a regular file", path);
  if (file < 0 && errno == EACCES) return Fail("{}: cannot be opened (no permission?)", path);
  if (file < 0) return Fail("{}: cannot be opened: {}", path, std::strerror(errno));
  return file;
}

}  // namespace

Result<std::string> ReadFile(const std::string& path) {
  SINEW_ASSIGN(const int file, Open(path));
  Result<std::string> bytes = ReadOpen(file, path);
  close(file);
  return bytes;
}

Result<std::string> ReadFileStart(const std::string& path, std::size_t most) {
  SINEW_ASSIGN(const int file, Open(path));
  Result<std::string> bytes = ReadStart(file, path, most);
  close(file);
  return bytes;
}

}  // namespace sinew
