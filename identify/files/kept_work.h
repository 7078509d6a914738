// /resume of an unfinished run file: what --resume takes over besides the trace.
#pragma once

#include <string>
#include <vector>

#include "base/error.h"
#include "base/hdf5_tree.h"
#include "identify/execution/evaluator.h"
#include "identify/execution/fit_record.h"

namespace sinew::files {

/// @param record may be null. Writes nothing if there is nothing.
void WriteKeptWork(const std::vector<KeptResiduals>& residuals, const FitRecord* record, Hdf5Node& root);

struct KeptWork {
  std::vector<KeptResiduals> residuals;
  FitRecord::Answers fits;
};

/// Nothing if the file has no /resume. Errors: incomplete, or of evaluations that the trace does not have.
Result<KeptWork> ReadKeptWork(const std::string& path, const Hdf5Node& root, std::size_t evaluations);

}  // namespace sinew::files
