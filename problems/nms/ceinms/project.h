// A CEINMS project as a data set: the files that a calibration or an execution names.
#pragma once

#include <string>
#include <vector>

#include "base/error.h"
#include "datasets/dataset.h"

namespace sinew {

struct CeinmsProject {
  Dataset data;                    ///< trials, subject.xml and nms.yaml
  std::vector<std::string> notes;  ///< what is read otherwise than CEINMS would, and what is not read
};

/// Reads the setup of a calibration (<ceinmsCalibration>) or of an execution (<ceinms>), and everything that
/// it names: subject, excitation generator, calibration or execution, trials with their .sto and .mot files.
/// Names of files are relative to the file that names them.
///
/// Trials are named by their file without .xml; those of the calibration are for training. Grids:
/// `excitations` (per muscle, the weighted sum of its inputs), `lengths`, `moment_arms.JOINT`, `moments`
/// (JOINT_moment). nms.yaml selects CEINMS's own numbers (as_ceinms), its objective, and the calibration's
/// parameters and ranges; c1 and c2, which can be exchanged, become the mean and the spread of the poles.
/// An execution gives the ranges that CEINMS users have (SCIENCE section 3).
///
/// A calibration file of CEINMS-RT (<simulatedAnnealing>) is read as described at ReadCeinmsRtProject.
/// @param validate trial files to predict only. @param execution of CEINMS-RT, else empty
/// Errors, with file and line: a file that is not there, elements that make no sense, muscles without input.
Result<CeinmsProject> ReadCeinmsProject(const std::string& setup, const std::vector<std::string>& validate,
                                        const std::string& execution = "");

}  // namespace sinew
