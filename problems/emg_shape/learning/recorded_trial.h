// One trial as it was recorded: its cycles, where in them every sample is, and which samples are compared.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "datasets/dataset.h"
#include "problems/emg_shape/data.h"

namespace sinew {

struct RecordedTrial {
  EmgShapeTrial trial;  ///< name, role, speed, period, cycles, times, phases and angles
  /// Muscle -> EMG at trial.time; over a gap its last value before it.
  std::map<std::string, std::vector<double>> recorded;
  std::map<std::string, std::vector<double>> measured;  ///< the same, NaN where nothing is compared
};

/// Nothing if the trial is left out; `notes` has the reason, and what else was left out. Errors: no angle or
/// no excitations of a training trial, another unit, those of FindCycles and CheckMuscle.
Result<std::optional<RecordedTrial>> ReadRecordedTrial(const std::string& name, const Trial& trial,
                                                       const EmgShapeSettings& settings,
                                                       std::vector<std::string>& notes);

}  // namespace sinew
