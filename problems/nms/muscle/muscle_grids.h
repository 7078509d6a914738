// Lengths and moment arms of a model's muscles as grids of a trial, where they are not in files.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "base/error.h"
#include "datasets/dataset.h"
#include "models/multibody/multibody_model.h"
#include "models/multibody/muscle_geometry.h"
#include "models/multibody/osim_muscle_reader.h"

namespace sinew {

/// What is wanted of a model.
struct MuscleGridsRequest {
  std::vector<std::string> muscles;  ///< empty: all of the model
  /// Coordinates about which moment arms are wanted; "all" alone: the independent angles that move one of the
  /// muscles.
  std::vector<std::string> joints;
  bool skip_unsupported = false;  ///< leaves out muscles with parts that are not supported
  std::string asked_by;           ///< who named the joints, for messages
  std::string remedy = {};        ///< what to do about muscles that are not supported, for messages
};

class MuscleGrids {
 public:
  /// @param text, name of an .osim; the name is for messages only. Errors: those of the readers; a joint that
  /// the model lacks, that is a length, that depends on another one or is named twice; no muscle.
  static Result<MuscleGrids> Build(const std::string& text, const std::string& name,
                                   MuscleGridsRequest request);

  /// The grid with the most coordinates of the model; nullptr if there is none.
  [[nodiscard]] const Grid* FindMotion(const Trial& trial) const;

  /// Adds the grids `lengths` and `moment_arms.JOINT` at the times of a grid of coordinates, in place of
  /// grids of these names. @return notes. Errors: an angle in another unit than rad;
  /// those of CoordinateTrajectory and MuscleGeometry.
  [[nodiscard]] Result<std::string> Add(const Grid& motion, Trial& trial) const;

  /// Muscles that were left out, see MuscleGridsRequest.
  [[nodiscard]] const std::vector<UnsupportedMuscle>& skipped() const { return skipped_; }

  /// Muscles whose paths may wrap over two objects or more, where OpenSim's own lengths differ by millimetres
  /// (docs/muscle_geometry.md).
  [[nodiscard]] const std::vector<std::string>& over_several_objects() const { return over_several_; }

  [[nodiscard]] const MultibodyModel& model() const { return *model_; }

 private:
  MuscleGrids(std::unique_ptr<const MultibodyModel> model, MuscleGeometry muscles,
              std::vector<std::string> joints, std::vector<int> indices);
  [[nodiscard]] std::vector<std::string> CoordinatesOn(const Grid& grid) const;
  [[nodiscard]] Result<CoordinateTrajectory> FitTrajectory(const Grid& grid) const;

  std::unique_ptr<const MultibodyModel> model_;  // the muscles refer to it
  MuscleGeometry muscles_;
  std::vector<std::string> joints_;
  std::vector<int> joint_indices_;
  std::vector<UnsupportedMuscle> skipped_;
  std::vector<std::string> over_several_;
};

}  // namespace sinew
