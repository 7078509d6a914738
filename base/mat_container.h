// What a MAT file is made of before its variables are read: the version, and whether all of it is there.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"

namespace sinew {

enum class MatVersion { k5, k73 };

/// @param file name for the message. Errors: empty; not a MAT file; version 4 or an unknown one; HDF5 without
/// MATLAB's header.
Result<MatVersion> FindMatVersion(std::string_view bytes, const std::string& file);

/// Counts the elements of a version 5 file; there is one for each variable, and MATLAB's own. Errors: one
/// that does not end within the file; a compressed one that disagrees with its checksum (libmatio takes what
/// is there, and does not look at the checksum).
Result<std::size_t> CountMat5Elements(std::string_view bytes, const std::string& file);

/// A variable of version 5 that is an object of MATLAB, such as a table: libmatio says neither its name nor
/// its class.
struct Mat5Object {
  std::string name;
  std::string class_name;
};

/// @pre CountMat5Elements found no fault.
[[nodiscard]] std::vector<Mat5Object> FindMat5Objects(std::string_view bytes);

}  // namespace sinew
