// Whether the cost that a run file states is that of its point: a file may have been changed, or come from
// another build.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "identify/files/run_file.h"

namespace sinew::files {

/// Evaluates the best point of the trace again. Errors: no prediction there; a cost that differs by more than
/// rounding on another machine.
Status CheckBestCost(const std::string& path, const RecordedRun& run, const LeastSquares& fit);

/// What must be said of a result that begins with the answer of this run: it was not finished, it states
/// another cost than its parameters have. The cost is looked at if the run was of the same data and of the
/// parameters of this problem, and of all steps at once.
[[nodiscard]] std::vector<Warning> WarningsOfRun(const std::string& path, const RecordedRun& run,
                                                 const Problem& problem, const std::string& data_hash);

}  // namespace sinew::files
