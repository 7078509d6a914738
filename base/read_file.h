// Files that are read whole.
#pragma once

#include <cstddef>
#include <string>

#include "base/error.h"

namespace sinew {

/// The bytes of a regular file; does not wait where a pipe has no writer, nor read a device that never ends.
/// Errors: no such file; a folder; a device, a pipe or a socket; no permission; larger than 4 GiB; not
/// readable.
Result<std::string> ReadFile(const std::string& path);

/// As ReadFile, but at most the first `most` bytes, of a file of any size.
Result<std::string> ReadFileStart(const std::string& path, std::size_t most);

}  // namespace sinew
