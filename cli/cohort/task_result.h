// What has become of one step of one subject.
#pragma once

#include <string>

namespace sinew::cohort {

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

}  // namespace sinew::cohort
