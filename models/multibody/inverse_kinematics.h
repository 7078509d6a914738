// Inverse kinematics: the coordinates that bring a model's markers closest to the measured ones.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "models/multibody/ik_setup.h"
#include "models/multibody/multibody_model.h"

namespace sinew {

/// Measured markers in ground axes. A marker that is missing in a frame has a NaN component.
struct MarkerTrajectories {
  std::vector<double> times;                 ///< [N, s]
  std::vector<std::string> names;            ///< [M]
  std::vector<std::vector<Vec3>> positions;  ///< [N][M, m]
};

struct IkOptions {
  /// A frame is solved when no coordinate would move by more than this [rad or m].
  double accuracy = 1e-9;
  int max_iterations = 200;
  std::uint64_t seed = 0;  ///< of the random starts
  /// Called after each frame with frames done and frames in all; may be empty.
  std::function<void(int, int)> progress;
};

struct IkResult {
  std::vector<double> times;                  ///< [N, s]
  std::vector<std::string> coordinate_names;  ///< [C], the model's
  Matrix coordinates;                         ///< [N x C, rad or m]; NaN in frames without any marker
  Vector marker_rms_m;                    ///< [N], over the tracked markers present in the frame, unweighted
  Vector marker_max_m;                    ///< [N]
  std::vector<std::string> worst_marker;  ///< [N], the one of marker_max_m; empty in frames without any
  std::vector<std::string> tracked;       ///< markers with a positive weight in model and measurement
  std::vector<std::string> unmatched;     ///< measured markers that the model lacks
  std::vector<std::string> undetermined;  ///< free coordinates that no tracked marker or task ever moves
  /// Free coordinates that no marker or task moves in some frames only, where they stay near the neighbours'
  /// values, with the number of those frames.
  std::vector<std::pair<std::string, int>> undetermined_in;
  std::vector<int> unconverged;  ///< frames that stopped at max_iterations
  int starts = 0;                ///< of the frame with which the search begins
  int agreeing_starts = 0;       ///< those that end at its lowest cost
  std::vector<int> redone;       ///< frames whose first minimum was not the lowest one found
};

/// Minimises in each frame `sum w_i |m_i(q) - o_i|^2 / sum w_i + sum w_c (q_c - target_c)^2` over the free
/// coordinates q (Lu, O'Connor 1999; the weighting is OpenSim's). Locked coordinates stay at their default,
/// clamped ones in their range, dependent ones follow their couplers exactly. The search begins with the
/// first frame in which most markers are present, from several starts (first_pose.h), and goes from frame to
/// frame in both directions; frames are redone until none falls when started from a neighbour's pose
/// (frame_passes.h). A finite number of starts proves nothing: the cost is the lowest that was found. The
/// answer is the same on every run.
///
/// The solver is Gauss-Newton with Levenberg's damping and projection on the ranges, on the markers' analytic
/// Jacobian.
///
/// @param setup  weights; markers without a task are not tracked. Null: every marker has weight 1.
/// Errors: model and measurement share no marker (both sets of names are shown), no marker has a positive
/// weight, arrays of different sizes, a coordinate task that names an unknown coordinate or takes its values
/// from a file.
Result<IkResult> SolveInverseKinematics(const MultibodyModel& model, const MarkerTrajectories& markers,
                                        const IkSetup* setup = nullptr, const IkOptions& options = {});

}  // namespace sinew
