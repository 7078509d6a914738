// Recorded trials as the nms problem sees them: excitations, lengths and moment arms of muscles, moments of
// joints.
#pragma once

#include <string>
#include <vector>

#include "base/error.h"
#include "datasets/dataset.h"
#include "identify/layout.h"
#include "problems/nms/nms_settings.h"

namespace sinew {

struct NmsTrial {
  std::string name;
  std::vector<double> time;               ///< [N, s] of lengths, moment arms and predictions
  std::vector<MuscleSignals> muscles;     ///< [muscles of NmsData]
  std::vector<std::vector<Vector>> arms;  ///< [joints][muscles of the joint] [N, m]
  int first_block = 0;                    ///< one per joint
};

struct NmsData {
  std::vector<std::string> muscles;             ///< that move a joint which is fitted
  std::vector<std::vector<int>> joint_muscles;  ///< [joints] indices into muscles
  std::vector<NmsTrial> trials;
  Layout layout;    ///< channels JOINT_moment
  double rate = 0;  ///< of the lengths, in the first trial [1/s]
  std::vector<std::string> notes;
};

[[nodiscard]] std::string DescribeNmsChannels();

/// Excitations outside of 0..1 are cut off, with one note for all. Moments are compared where a length was
/// recorded at the same time.
/// Errors, with the trial's name: a grid or a channel that is missing, another unit, a gap, a trial without
/// any measured moment, a moment that does not change; no training trial.
Result<NmsData> PrepareNmsData(const Dataset& data, const NmsSettings& settings);

}  // namespace sinew
