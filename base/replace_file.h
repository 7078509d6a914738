// Files that are replaced whole and in one step: the only way in which the program writes a file.
#pragma once

#include <string>
#include <string_view>

#include "base/error.h"

namespace sinew {

/// Whether a file can be put there, as far as that is known before there is one to write.
///
/// Errors: a folder; a device, a pipe or a socket, which a renamed file would take the place of; links that
/// lead in a circle; a name or a path longer than the file system takes; no such folder; no permission to
/// write there; a file that is write-protected, on a file system that is read-only, or without any room.
Status CheckReplaceable(const std::string& path);

/// The path with its symbolic links followed, also where they lead to a file that does not exist yet.
/// Errors: links that lead in a circle.
Result<std::string> ResolveLinks(const std::string& path);

/// Writes under a temporary name in the target's folder, makes sure that the bytes are on the disk (fsync),
/// and renames: whoever reads the file, or kills the writer, finds the old one or the new one, never half of
/// one. A symbolic link stays, and what it leads to is replaced; permissions, and where allowed the owner,
/// stay those of the old file. What killed processes have left under temporary names in the folder is
/// removed.
///
/// Errors, which leave the old file as it was and nothing beside it: those of CheckReplaceable; no room on
/// the disk, or more bytes than a file may have (setrlimit RLIMIT_FSIZE, whose signal SIGXFSZ does not reach
/// the process); anything else that the file system refuses. One error comes after the file has been
/// replaced, and says so: the folder could not be brought to the disk.
Status ReplaceFile(const std::string& path, std::string_view bytes);

}  // namespace sinew
