// Recorded trials as the nms problem uses them: excitations, lengths and moment arms of muscles, moments of
// joints.
#pragma once

#include <string>
#include <vector>

#include "base/error.h"
#include "datasets/dataset.h"
#include "identify/layout.h"
#include "problems/nms/settings.h"

namespace sinew {

/// A joint's recorded angle and its derivatives, at the times of the lengths; empty if it was not recorded.
struct NmsMotion {
  Vector angle;         ///< [N, rad]
  Vector velocity;      ///< [N, rad/s]
  Vector acceleration;  ///< [N, rad/s2]
};

struct NmsTrial {
  std::string name;
  std::vector<double> time;               ///< [N, s] of lengths, moment arms and predictions
  std::vector<MuscleSignals> muscles;     ///< [muscles of NmsData]
  std::vector<std::vector<Vector>> arms;  ///< [joints][muscles of the joint] [N, m]
  std::vector<NmsMotion> motion;          ///< [joints]
  /// [joints] [N, 0..1] mean activation, with the subject's own numbers, of the muscles with a moment about
  /// the joint towards larger and towards smaller angles; 0 if there is none.
  std::vector<Vector> pull_plus;
  std::vector<Vector> pull_minus;
  int first_block = 0;         ///< one per joint
  int first_fibre_block = -1;  ///< one per muscle; -1: none
};

struct NmsData {
  std::vector<std::string> muscles;             ///< that move a joint which is fitted
  std::vector<std::vector<int>> joint_muscles;  ///< [joints] indices into muscles
  std::vector<std::vector<int>> muscle_joints;  ///< [muscles] the joints that each crosses, <= kMaxJoints
  std::vector<NmsTrial> trials;
  /// Channels JOINT_moment; of settings with a fibre range also MUSCLE_fibre_length [1, of the optimal one]
  /// of training trials.
  Layout layout;
  double rate = 0;  ///< of the lengths, in the first trial [1/s]
  std::vector<std::string> notes;
};

[[nodiscard]] std::string DescribeNmsChannels();

/// Excitations outside of 0..1 are cut off, with one note for all. Moments are compared where a length was
/// recorded at the same time.
/// Errors, with the trial's name: a grid or a channel that is missing, another unit, a gap, a trial without
/// any measured moment, a moment that does not change; no trial.
/// @param unmeasured muscles whose excitation is not looked for; it is 0.
Result<NmsData> PrepareNmsData(const Dataset& data, const NmsSettings& settings,
                               const std::vector<std::string>& unmeasured = {});

}  // namespace sinew
