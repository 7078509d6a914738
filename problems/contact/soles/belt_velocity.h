// How fast the floor moves under flat feet: a treadmill's belt.
#pragma once

#include <vector>

#include "datasets/dataset.h"
#include "models/multibody/multibody_model.h"
#include "models/multibody/osim_model.h"
#include "problems/contact/soles/foot_estimate.h"
#include "problems/contact/soles/plate_record.h"

namespace sinew {

struct BeltVelocity {
  double x = 0;  ///< [m/s] along an axis; 0 where it does not differ from 0
  double z = 0;
  double found_x = 0;  ///< as found [m/s]
  double found_z = 0;
  double error_x = 0;  ///< its standard error [m/s]
  double error_z = 0;
  int stances = 0;
  bool by_markers = false;  ///< else by the bodies of the model
};

/// A foot on its stance.
struct StandingFoot {
  const PlateRecord* record = nullptr;
  const FootEstimate* foot = nullptr;
};

/// Median velocity of the foot's measured markers, or of its body's sole, while it is flat, mean over the
/// stances. The foot rolls and its skin slides by a few millimetres in the tenth of a second that it is flat:
/// 0.03 m/s, which no number of stances lessens. A component counts if it exceeds three standard errors.
[[nodiscard]] BeltVelocity FindBeltVelocity(const std::vector<StandingFoot>& feet, const Dataset& data,
                                            const OsimModel& model, const MultibodyModel& multibody);

}  // namespace sinew
