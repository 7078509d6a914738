// Markers of a data set become coordinates of a model: inverse kinematics of every trial that has markers.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "base/error.h"
#include "datasets/dataset.h"
#include "models/multibody/inverse_kinematics.h"

namespace sinew {

/// How closely the model follows the markers of one trial.
struct KinematicsFit {
  std::string trial;
  std::size_t frames = 0;
  std::size_t markers = 0;                ///< tracked
  double rms_m = 0;                       ///< over the frames with markers [m]
  double max_m = 0;                       ///< largest distance of a marker in any frame [m]
  std::string worst_marker;               ///< the marker and the frame of that distance
  std::size_t worst_frame = 0;            ///< counted from 0
  double worst_time = 0;                  ///< [s]
  std::vector<std::string> unmatched;     ///< measured markers that the model lacks
  std::vector<std::string> undetermined;  ///< free coordinates that no marker moves
  /// Free coordinates that no marker moves in that many frames, but in others.
  std::vector<std::pair<std::string, int>> undetermined_in;
  std::size_t unconverged = 0;  ///< frames whose search did not converge
  int starts = 0;               ///< of the frame with which the search begins
  int agreeing_starts = 0;      ///< those that end at its lowest cost; 0: it was found from their best one
  std::size_t redone = 0;       ///< frames that got a lower minimum than their first one
};

/// Adds (or replaces) the grid `coordinates` [rad or m] of every trial that has a grid `markers`, in which a
/// marker is the three channels NAME_x, NAME_y, NAME_z. Trials are solved side by side; the answer does not
/// depend on the number of threads.
/// @param setup null: every marker has weight 1
/// @param seed of the random starts
/// @param progress frames done and in all; called from one thread at a time
/// @return one fit per trial with markers, in the order of their names; empty if there is none
/// Errors: those of SolveInverseKinematics, with the trial. The data set is then unspecified.
Result<std::vector<KinematicsFit>> AddCoordinates(const MultibodyModel& model, const IkSetup* setup,
                                                  std::uint64_t seed,
                                                  const std::function<void(int done, int all)>& progress,
                                                  Dataset& data);

}  // namespace sinew
