// /searches of a run file: the local searches of a search from many starts that have come to their end.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/hdf5_tree.h"
#include "identify/execution/finished_search.h"

namespace sinew::files {

/// @param variables [n] of the fit
void WriteSearches(const std::vector<FinishedSearch>& searches, std::size_t variables, Hdf5Node& node);

/// None if the file has no /searches. Errors: incomplete, or of evaluations that the trace does not have.
Result<std::vector<FinishedSearch>> ReadSearches(const std::string& path, const Hdf5Node& root,
                                                 std::size_t evaluations, std::size_t variables);

}  // namespace sinew::files
