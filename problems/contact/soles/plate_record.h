// What one plate measured in one trial, frame by frame of the motion, beside where all bodies were.
#pragma once

#include <string>
#include <vector>

#include "datasets/dataset.h"
#include "models/multibody/multibody_model.h"

namespace sinew {

struct PlateRecord {
  std::string trial;
  std::string plate;
  Role role = Role::kTrain;
  std::vector<double> time;                     ///< [T, s] frames of the motion while the plate records
  std::vector<std::vector<BodyMotion>> motion;  ///< [T][bodies of the model]
  std::vector<Vec3> force;                      ///< [T, N] mean over a frame; NaN where it was not measured
  std::vector<Vec3> cop;                        ///< [T, m] on the floor; NaN where the foot is light
  double peak = 0;                              ///< largest vertical force of a frame [N]
  double lowest = 0;                            ///< smallest vertical force of a frame [N]
  bool has_cop = false;                         ///< in some frame
  bool partial = false;  ///< it begins or ends within a stance, whose frames are taken for unloaded

  [[nodiscard]] bool Loaded(std::size_t frame, double share) const { return force[frame].y() > share * peak; }
};

/// The centre of pressure is used above this share of the largest vertical force.
constexpr double kLoadedShare = 0.1;

/// One record for every plate (PLATE_force_y) of every trial that has coordinates of the model.
/// @param floor_height [m] at which the centre of pressure lies
/// @param skipped receives a sentence per trial whose motion or plate cannot be used
/// Errors: no trial has both.
Result<std::vector<PlateRecord>> ReadPlateRecords(const Dataset& data, const MultibodyModel& model,
                                                  double floor_height, std::vector<std::string>& skipped);

}  // namespace sinew
