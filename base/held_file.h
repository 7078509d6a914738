// Files that exist only while a process works: temporary ones and locks. A folder on a shared disk is used by
// processes of several machines, any of which may be killed, so "is its process alive" cannot be asked by its
// number. Instead each holds an advisory lock (flock) on its file: it ends with the process, and whoever gets
// it finds the file abandoned.
#pragma once

#include <string>

namespace sinew {

/// An open file on which a lock is held; closed, and removed if it is still there under its name, at the end.
class HeldFile {
 public:
  HeldFile() = default;
  HeldFile(std::string path, int descriptor);
  ~HeldFile();
  HeldFile(HeldFile&& other) noexcept;
  HeldFile& operator=(HeldFile&& other) noexcept;
  HeldFile(const HeldFile&) = delete;
  HeldFile& operator=(const HeldFile&) = delete;

  [[nodiscard]] const std::string& path() const { return path_; }
  [[nodiscard]] int descriptor() const { return descriptor_; }
  /// Closes it, and removes nothing: it has become another file (by rename).
  void Keep();

 private:
  void Drop();

  std::string path_;
  int descriptor_ = -1;
};

/// A new file in the folder, under a name of 41 bytes at most that no other process uses. @return 0 or errno
int MakeTemporaryFile(const std::string& folder, HeldFile& file);

/// The file under this name, made if it is not there, with the lock on it.
/// @return 0, or errno; EWOULDBLOCK: another process, or another HeldFile of this one, holds it; ENOTSUP:
/// this file system has no locks
int HoldFile(const std::string& path, HeldFile& file);

/// The name of the lock of a file: same folder, of 28 bytes.
std::string LockNameOf(const std::string& file_name);

/// Removes temporary files and locks of this program whose processes are gone, once per folder and process.
/// Those of other machines only if they are an hour old: locks of some network file systems hold on one
/// machine only.
void RemoveAbandonedFiles(const std::string& folder);

/// Removes all held files of this process now, before it ends without destructors. Another thread that would
/// hold or give back a file waits from here on.
void RemoveHeldFiles();

}  // namespace sinew
