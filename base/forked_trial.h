// Readers of binary files that damaged bytes can crash: they work in a process of their own first.
#pragma once

#include <cstddef>
#include <functional>
#include <mutex>
#include <string>

#include "base/error.h"

namespace sinew {

/// Held while libhdf5 works, alone or under libmatio: it is not thread-safe in every build, and see
/// TryInOwnProcess.
std::mutex& Hdf5Mutex();

/// Does `work`, the reading of the file at `path`, in a forked process, and returns the bytes that it
/// returned.
///
/// Libraries do not check all sizes and offsets in a file: damaged ones crash them, put them into an endless
/// loop, or make them ask for all memory. Errors: those of `work`; "is damaged" where the process crashed,
/// took more than 10 s of processor time and 1 s for every MiB of the file, or more memory than is allowed.
///
/// Whoever reads the file again in this process behaves equally only if this process is where the other one
/// was: not if `work` called the library for something else before. Bytes are the safer way to bring the
/// content over; they come from a process that was not stopped by what it read, so check them.
///
/// @param library that reads, for the message: "HDF5"
/// @param memory [bytes] that the process may take in addition to what this one has; 0: no limit
/// @pre the caller holds Hdf5Mutex(). Fork copies the calling thread only: a lock held by another thread
/// stays locked in the copy. So `work` may call that library, the C library (which handles its allocator and
/// streams) and what needs no lock, nothing else. If it should hang nevertheless, its alarm ends it.
Result<std::string> TryInOwnProcess(const std::string& path, const std::string& library, std::size_t memory,
                                    const std::function<Result<std::string>()>& work);

}  // namespace sinew
