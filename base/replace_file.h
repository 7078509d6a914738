// Files that are replaced whole and in one step.
#pragma once

#include <string>
#include <string_view>

#include "base/error.h"

namespace sinew {

/// Whether a file may be put there: nothing is at `path` yet, or a regular file, perhaps behind a symbolic
/// link. Errors: a folder; a device, a pipe or a socket, which a renamed file would take the place of.
Status CheckReplaceable(const std::string& path);

/// Writes beside the target and renames over it: whoever reads the file, or kills the writer, finds the old
/// one or the new one, never half of one. A symbolic link stays, and what it leads to is replaced.
///
/// Errors, which leave the old file as it was and nothing beside it: those of CheckReplaceable; the folder is
/// not there or may not be written to; no room on the disk, or more bytes than a file may have (setrlimit
/// RLIMIT_FSIZE, whose signal SIGXFSZ does not reach the process).
Status ReplaceFile(const std::string& path, std::string_view bytes);

}  // namespace sinew
