// The groups that a run file and a diagnosis file share: docs/run_file.md.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/hdf5_tree.h"
#include "identify/files/run_file.h"
#include "identify/text/sentence.h"

namespace sinew::files {

/// Attributes of /run that state the origin of its answer, and /run/config.
void WriteProvenance(const Provenance& provenance, const std::string& solver, std::uint64_t seed,
                     Hdf5Node& run);

/// /parameters. @param values [P]
void WriteParameters(const FitSetup& setup, const Vector& values, Hdf5Node& node);

/// findings, finding_kinds, warnings and warning_kinds of /run. @param texts of the warnings
void WriteSentences(const std::vector<text::Sentence>& findings, const std::vector<Warning>& warnings,
                    const std::vector<std::string>& texts, Hdf5Node& run);

/// /prediction and /residual.
void WritePredictions(const Layout& layout, const FullPrediction& prediction, Hdf5Node& root);

}  // namespace sinew::files
