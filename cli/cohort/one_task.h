// One step of one subject: its commands, unless it is done already, and the record of what became of it.
#pragma once

#include "cli/cohort/children.h"
#include "cli/cohort/pipeline.h"
#include "cli/cohort/step_state.h"
#include "cli/cohort/task_result.h"

namespace sinew::cohort {

/// A step is done again unless its record (StepStates) says that it was done by this version, with the same
/// words and the same bytes in all files that it reads, and what it wrote is unchanged. One that was stopped
/// goes on with --resume, if its command has that.
/// @pre no other step of this subject is being done
TaskResult DoTask(const Pipeline& pipeline, const Task& task, const Program& program, int threads,
                  Children& children);

}  // namespace sinew::cohort
