// /trace of a run file, and what resuming a search takes from it.
#pragma once

#include <string>
#include <vector>

#include "base/error.h"
#include "base/hdf5_tree.h"
#include "identify/execution/search_record.h"

namespace sinew::files {

/// /trace, and /resume/outcomes where the trace has not all evaluations. @param variables names of the free
/// parameters
void WriteTrace(const SearchRecord& record, const std::vector<std::string>& variables, Hdf5Node& root);

struct RecordedTrace {
  std::vector<std::string> variables;
  SearchRecord record;
};

/// Errors, with the path: incomplete, or parts that do not belong together. Files of earlier versions lack
/// `evaluation` and `level`: they have all evaluations.
Result<RecordedTrace> ReadTrace(const std::string& path, const Hdf5Node& root);

}  // namespace sinew::files
