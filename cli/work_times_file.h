// --work-times FILE: how long the pieces of independent work took.
#pragma once

#include <string>

#include "base/error.h"
#include "identify/execution/shared_loop.h"
#include "identify/execution/work_times.h"

namespace sinew {

/// Processes and times of one command.
class WorkTimesFile {
 public:
  /// @param path of the option; empty: it was not given
  explicit WorkTimesFile(std::string path);

  /// With the processes of TheRanks().
  [[nodiscard]] SharedWork work();
  /// Writes the file, as JSON (schema sinew.work_times/1): `processor_seconds` of the whole process,
  /// `loops[{pieces[], processor_seconds, repeated}]`.
  [[nodiscard]] Status Write() const;

 private:
  std::string path_;
  WorkTimes times_;
};

}  // namespace sinew
