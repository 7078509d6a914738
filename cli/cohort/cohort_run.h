// Does the steps of all subjects: each when those before it are done, several subjects at once.
#pragma once

#include <functional>
#include <vector>

#include "cli/cohort/children.h"
#include "cli/cohort/pipeline.h"
#include "cli/cohort/task_result.h"
#include "identify/execution/ranks.h"

namespace sinew::cohort {

struct CohortOptions {
  int threads = 1;  ///< of this process, for all of its commands together
  std::function<void(int done, int all)> progress;
  Ranks* ranks = nullptr;  ///< other processes, which do tasks as well (HelpWithCohort); may be null
};

/// Every task as DoTask does it (one_task.h).
/// @param children told by the caller to stop
/// @return [tasks], in their order; depends neither on threads and processes nor on the order in which tasks
/// ended. Errors: a folder of results cannot be made, or a record of steps not be read: nothing was run then.
Result<std::vector<TaskResult>> RunCohort(const Pipeline& pipeline, const Program& program,
                                          const CohortOptions& options, Children& children);

/// Of a process other than rank 0: does the tasks that rank 0 sends, which sees the same files. Returns once
/// it was told to stop and has ended all of them; else the process ends when rank 0 does.
void HelpWithCohort(const Pipeline& pipeline, const Program& program, const CohortOptions& options,
                    Children& children, const std::function<bool()>& told_to_stop);

}  // namespace sinew::cohort
