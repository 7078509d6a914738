// An HDF5 file of somebody else can name any file of the user: as the target of a link, or as the home of its
// numbers. Neither is followed. For the readers of base: the identifiers are HDF5's.
#pragma once

#include <cstdint>
#include <string>

#include "base/error.h"

namespace sinew {

/// A property list with which opening an object follows no link to another file, also not on the way of a
/// link within this one; negative if there is no memory for it. To be closed by H5Pclose.
std::int64_t AccessWithinThisFile();

/// Errors: the member of the group is no hard or soft link.
Status RefuseLinkToOtherFile(std::int64_t group, const std::string& name, const std::string& where);

/// Errors: the numbers are in other files (external storage, virtual dataset). To be asked before anything
/// else of a dataset: its extent alone can open them.
Status RefuseStorageInOtherFile(std::int64_t dataset, const std::string& where);

/// Its errors become ours, not a stack trace on stderr.
void SilenceHdf5();

/// The two above for everything in the file at `path`, before a library reads it that would follow them.
Status RefuseOtherFiles(const std::string& path);

}  // namespace sinew
