// The files that a command reads and writes: none of them may be another one of them.
#pragma once

#include <string>
#include <vector>

#include "base/error.h"

namespace sinew {

struct CommandFiles {
  std::vector<std::string> read;     ///< an empty name is an option that was not given
  std::vector<std::string> written;  ///< of options that must name a file
  std::string json;                  ///< empty: was not asked for; "-": standard output
};

/// Asked before long work, so that it is not lost. Files are compared by what they are, not by their names: a
/// link and another way to write the same path are the same file, also where it does not exist yet.
///
/// Errors: a written file is one that is read, or is written twice; its name is empty or "-"; it is a folder,
/// a device, a pipe or a socket; its folder does not exist or may not be
/// written to; its name is too long.
Status CheckFiles(const CommandFiles& files);

/// CheckFiles for a data set that is changed in place unless another one is named.
/// @param out of --out; empty: in place. @param read what is read besides
Status CheckInPlace(const std::string& data, const std::string& out, const std::vector<std::string>& read,
                    const std::string& json);

}  // namespace sinew
