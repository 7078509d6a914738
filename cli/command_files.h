// The files that a command reads and writes: none of them may be another one of them.
#pragma once

#include <string>
#include <vector>

#include "base/error.h"
#include "base/file_lock.h"

namespace sinew {

struct CommandFiles {
  std::vector<std::string> read;     ///< an empty name is an option that was not given
  std::vector<std::string> written;  ///< of options that must name a file
  std::string json;                  ///< empty: was not asked for; "-": standard output
};

/// Asked before long work, so that it is not lost. Files are compared by what they are, not by their names: a
/// link and another way to write the same path are the same file, also where it does not exist yet.
///
/// Errors: a written file is one that is read, or is written twice; its name is empty or "-"; those of
/// CheckReplaceable.
Status CheckFiles(const CommandFiles& files);

/// The right to change the files that a command writes, until it ends.
using FileLocks = std::vector<FileLock>;

/// What a command does if another process is changing a file that it is to write.
enum class IfBusy {
  kWait,   ///< says so and waits: what is changed takes seconds
  kRefuse  ///< after two seconds; for work that takes long, of which two into one file are surely a mistake
};

/// CheckFiles, then the locks of what is written. Where the file system has no locks, a warning on standard
/// error says so. Errors: those of CheckFiles and FileLock::Try; a file is being written (kRefuse).
Result<FileLocks> ClaimFiles(const CommandFiles& files, IfBusy if_busy = IfBusy::kWait);

/// --resume where nothing was saved yet: a note on standard error says that the work begins.
void NoteBeginning(const std::string& out);

/// ClaimFiles for a data set that is changed in place unless another one is named.
/// @param out of --out; empty: in place. @param read what is read besides
Result<FileLocks> ClaimInPlace(const std::string& data, const std::string& out,
                               const std::vector<std::string>& read, const std::string& json);

}  // namespace sinew
