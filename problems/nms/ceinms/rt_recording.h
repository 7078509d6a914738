// The recording of one trial as CEINMS-RT's calibration takes it: ik.sto, id.sto and EMG.
#pragma once

#include <string>
#include <vector>

#include "base/error.h"
#include "datasets/dataset.h"
#include "problems/nms/ceinms/rt_emg.h"
#include "problems/nms/muscle/muscle_grids.h"

namespace sinew {

struct CeinmsRtFiles {
  std::string angles;
  std::string moments;
  std::string emg;
};

/// How recordings are read.
struct CeinmsRtReading {
  const MuscleGrids& grids;           ///< states which columns are angles
  std::vector<std::string> joints;    ///< whose angles and moments there must be
  std::vector<std::string> channels;  ///< of EMG
  const CeinmsRtEmg* filters;         ///< nullptr: the EMG is an envelope already
  double emg_delay_s = 0;             ///< added to the times of the EMG
};

/// Grids `coordinates`, `moments` (JOINT_moment; columns are called so or JOINT) and `excitations`, all of
/// them whole; what was filtered is not divided yet. Errors: those of the readers; a column that is missing;
/// a gap in EMG that is to be filtered.
Result<Trial> ReadCeinmsRtRecording(const CeinmsRtFiles& files, const CeinmsRtReading& reading,
                                    std::vector<std::string>& notes);

}  // namespace sinew
