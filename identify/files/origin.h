// What a result follows from: a run that is resumed has to have the same.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "base/hdf5_tree.h"
#include "identify/files/run_file.h"

namespace sinew::files {

/// Facts that a command adds to its origin, as ("--seed", "3").
using OriginFacts = std::vector<std::pair<std::string, std::string>>;

/// Attributes problem, data_hash, version and the facts; the settings; /parameters with bounds, starts,
/// priors and which are free.
[[nodiscard]] Hdf5Node OriginTree(const Provenance& provenance, const FitSetup& setup,
                                  const OriginFacts& facts);

/// Errors: the origins differ, and in what. @param path of the file that holds `then`
Status CheckSameOrigin(const std::string& path, const Hdf5Node& then, const Hdf5Node& now);

}  // namespace sinew::files
