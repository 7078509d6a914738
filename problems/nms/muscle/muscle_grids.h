// Lengths and moment arms of a model's muscles as grids of a trial, where they are not in files.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "base/error.h"
#include "datasets/dataset.h"
#include "models/multibody/multibody_model.h"
#include "models/multibody/muscle_geometry.h"

namespace sinew {

class MuscleGrids {
 public:
  /// @param text, name of an .osim; the name is for messages only. @param muscles empty: all of the model
  /// @param joints coordinates about which moment arms are wanted @param asked_by who named the joints, for
  /// messages. Errors: those of the readers; a joint that the model lacks, that is a length, that depends on
  /// another one or is named twice; no muscle.
  static Result<MuscleGrids> Build(const std::string& text, const std::string& name,
                                   std::vector<std::string> muscles, const std::vector<std::string>& joints,
                                   const std::string& asked_by);

  /// The grid with the most coordinates of the model; nullptr if there is none.
  [[nodiscard]] const Grid* FindMotion(const Trial& trial) const;

  /// Adds the grids `lengths` and `moment_arms.JOINT` at the times of a grid of coordinates, in place of
  /// grids of these names. @return notes. Errors: an angle in another unit than rad;
  /// those of CoordinateTrajectory and MuscleGeometry.
  [[nodiscard]] Result<std::string> Add(const Grid& motion, Trial& trial) const;

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
};

}  // namespace sinew
