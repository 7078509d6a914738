// Takes the runs of a comparison that was interrupted.
#pragma once

#include <string>
#include <vector>

#include "identify/files/study_file.h"

namespace sinew::files {

/// Errors: not a study file, damaged, or of another origin (CheckSameOrigin).
Result<std::vector<StudyRun>> ReadStudyRuns(const std::string& path, const FitSetup& setup,
                                            const Hdf5Node& origin);
/// The same of a file's content. @param path for messages
Result<std::vector<StudyRun>> StudyRunsOf(const std::string& path, const Hdf5Node& root,
                                          const FitSetup& setup, const Hdf5Node& origin);

}  // namespace sinew::files
