// The processes of `mpirun -n N sinew ...` (docs/cluster.md).
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "base/error.h"
#include "identify/execution/ranks.h"

namespace sinew {

/// Whether this process was started as one of several by mpirun, or by srun with PMIx.
bool StartedWithOthers();

/// Joins the others; they are TheRanks() until the result is destroyed. A process other than rank 0 prints
/// nothing from now on, and ends when rank 0 does. Errors: the module that speaks MPI is not there.
Result<std::unique_ptr<Ranks>> JoinRanks();

/// nullptr if this process works alone.
Ranks* TheRanks();
/// Whether this process works for rank 0 of several: it computes as rank 0 does, and writes nothing.
bool IsHelper();

/// For a process that was started by one of several, and is none of them: the environment without what would
/// make it look so.
std::vector<std::string> EnvironmentOfOneProcess();

}  // namespace sinew
