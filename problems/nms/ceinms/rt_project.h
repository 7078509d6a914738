// A CEINMS-RT project as a data set: what its calibration file names.
#pragma once

#include <string>
#include <vector>

#include "base/error.h"
#include "problems/nms/ceinms/project.h"

namespace sinew {

/// Reads CEINMS-RT's calibration file (<simulatedAnnealing>) and what it names: the subject
/// DIRECTORY/inputSubjectXMLName, the .osim, and per trial DIRECTORY/TRIAL/ik.sto, id.sto and emgFilt.sto (or
/// emg.sto, filtered as CEINMS-RT does). Files are found by FindCeinmsRtFile.
///
/// Grids of each trial: `coordinates`, `excitations` (by the subject's channels, at times later by EMD),
/// `moments`, and, from the .osim along the coordinates, `lengths` and `moment_arms.JOINT`. Its window is
/// counted from the first moment; inputs keep CutTrial's margin. subject.xml has C1 = C2 = 0, because
/// CEINMS-RT's activation has no filter.
/// @param execution CEINMS-RT's execution file, which states the tendon model; empty: executionRT.xml beside
/// the calibration file if it is there, else rigid.
/// @param validate trials to predict only: TRIAL or TRIAL:FROM:TO, in seconds from its first moment.
Result<CeinmsProject> ReadCeinmsRtProject(const std::string& calibration, const std::string& execution,
                                          const std::vector<std::string>& validate);

}  // namespace sinew
