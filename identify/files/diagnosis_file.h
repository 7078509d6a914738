// The file that a diagnosis leaves: a run file of the extended model, and /diagnosis (docs/run_file.md).
#pragma once

#include "base/error.h"
#include "base/hdf5_tree.h"
#include "identify/diagnosis/diagnosis.h"
#include "identify/files/run_file.h"

namespace sinew {

/// What a diagnosis file has as the solver of its run. The effects that it holds away from their null were
/// found.
inline constexpr const char* kDiagnoseSolver = "diagnose";

/// Whoever reads run files (ReadRun) finds the extended model in it: /parameters at the extended point, with
/// the effect parameters of the causes free.
///
/// Errors: those of the prediction at the extended point and of Problem::Describe.
Result<Hdf5Node> DiagnosisTree(const Problem& problem, const Diagnosis& diagnosis,
                               const Provenance& provenance, const DiagnosisOptions& options);

}  // namespace sinew
