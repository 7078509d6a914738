// Which trials of a CEINMS-RT project are wanted, to fit and to predict only.
#pragma once

#include <string>
#include <vector>

#include "base/error.h"
#include "datasets/dataset.h"
#include "problems/nms/ceinms/rt_calibration.h"

namespace sinew {

struct CeinmsRtWanted {
  std::string name;    ///< in the data set
  std::string folder;  ///< of the trials' directory
  double from_s = 0;   ///< from the first moment on; -infinity: where the recordings begin
  double to_s = 0;     ///< infinity: where they end
  Role role = Role::kTrain;
  long line = 0;  ///< where the calibration file names it
};

/// The calibration's trials and those to validate: TRIAL, or TRIAL:FROM:TO in seconds. They are called by
/// their folder, or, if that name is taken, TRIAL_FROM_TO. Errors: a word that is none; a name that is taken
/// twice.
Result<std::vector<CeinmsRtWanted>> ListCeinmsRtTrials(const CeinmsRtCalibration& calibration,
                                                       const std::string& file,
                                                       const std::vector<std::string>& validate);

}  // namespace sinew
