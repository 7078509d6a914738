// File and JSON of a comparison of solvers: docs/run_file.md.
#pragma once

#include <string>

#include "base/hdf5_tree.h"
#include "identify/files/run_file.h"
#include "identify/solvers/study.h"

namespace sinew::files {

/// Group /study, schema study/1. @param origin of files::OriginTree
[[nodiscard]] Hdf5Node StudyTree(const Problem& problem, const Study& study, const Provenance& provenance,
                                 const Hdf5Node& origin);

/// JSON of `compare`, schema sinew.study/1.
[[nodiscard]] std::string StudyJson(const Problem& problem, const Study& study, const Provenance& provenance);

}  // namespace sinew::files
