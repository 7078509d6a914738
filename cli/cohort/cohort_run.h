// Does the steps of all subjects: each when those before it are done, several subjects at once.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "cli/cohort/children.h"
#include "cli/cohort/pipeline.h"

namespace sinew::cohort {

/// What has become of a task.
enum class Outcome {
  kDone,
  kKept,  ///< was done before, from the same words and files
  kFailed,
  kNotRun,  ///< a step before it failed
  kStopped  ///< by a signal, or not begun because of one
};

struct TaskResult {
  Outcome outcome = Outcome::kStopped;
  double seconds = 0;  ///< of kKept: when it was done
  std::string reason;  ///< why it failed, or which step before it did
  std::string log;     ///< file of what it printed, relative to the pipeline's folder; empty if never run
};

struct CohortOptions {
  int threads = 1;  ///< for all commands together
  std::function<void(int done, int all)> progress;
};

/// A step is done again unless its record (StepStates) says that it was done by this version, with the same
/// words and the same bytes in all files that it reads, and what it wrote is unchanged. One that was stopped
/// goes on with --resume, if its command has that.
/// @param children told by the caller to stop
/// @return [tasks], in their order; depends neither on the threads nor on the order in which tasks ended.
/// Errors: a folder of results cannot be made, or a record of steps not be read: nothing was run then.
Result<std::vector<TaskResult>> RunCohort(const Pipeline& pipeline, const Program& program,
                                          const CohortOptions& options, Children& children);

}  // namespace sinew::cohort
