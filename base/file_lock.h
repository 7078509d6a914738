// One process at a time changes a file.
#pragma once

#include <string>

#include "base/error.h"
#include "base/held_file.h"

namespace sinew {

/// The right to change one file, for as long as the object lives. It is a lock (flock) on a small file beside
/// it, so that files can be locked that do not exist yet or are replaced meanwhile; it ends with the process,
/// however that ends.
class FileLock {
 public:
  /// Does not wait. Errors: those of ResolveLinks; the folder takes no file: not there, no permission, no
  /// room.
  static Result<FileLock> Try(const std::string& path);

  /// False if another process has the right now, or the file system has no locks.
  [[nodiscard]] bool held() const { return state_ == State::kHeld; }
  /// The file system has no locks: whoever else changes the file is not noticed.
  [[nodiscard]] bool unsupported() const { return state_ == State::kUnsupported; }
  /// Who has it, as "process 123 on anna"; empty if it did not say.
  [[nodiscard]] const std::string& holder() const { return holder_; }

 private:
  enum class State { kHeld, kElsewhere, kUnsupported };

  HeldFile file_;
  State state_ = State::kElsewhere;
  std::string holder_;
};

}  // namespace sinew
