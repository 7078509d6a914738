// The motion of a small humanoid robot during one stance: how it would really move, at any time, for
// synthetic data.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/linear_algebra.h"

namespace sinew {

/// One step: the stance foot comes down heel first, rolls flat, slides a little, and leaves over the toe,
/// while the other foot swings. Lengths are those of models `nao_like.osim` (sole 45.19 mm below the ankle,
/// thigh 100 mm, shank 102.9 mm) times `size`.
struct Step {
  bool right = true;             ///< the stance foot
  double size = 1;               ///< lengths of the body over those of nao_like.osim
  double duration = 32.0 / 60;   ///< of the stance [s]
  double walking_speed = 0.10;   ///< of the pelvis [m/s]
  double depth = 0.0045;         ///< of the flat sole below the floor's surface at mid-stance [m]
  double rocking = 0.02;         ///< share of the depth that comes and goes twice in the stance
  double strike_pitch = 0.06;    ///< of the foot at heel strike, toes up [rad]
  double push_off_pitch = 0.10;  ///< of the foot at toe-off, heel up [rad]
  double slip_speed = 0.05;      ///< of the sliding after strike and at push-off [m/s]
  double roll = 0.01;            ///< sideways rolling of the foot [rad]
  double pelvis_height = 0.232;  ///< over `size` [m]
};

/// By how much the stance foot lies elsewhere: in ground axes, turned about the middle of its sole.
struct FootError {
  Vec3 shift = Vec3::Zero();  ///< [m]
  Vec3 turn = Vec3::Zero();   ///< rotation vector [rad]
};

/// Coordinates of nao_like.osim by name [rad, m] at time t [s]; the stance lasts from 0 to Step::duration.
/// The pelvis and the other leg do not move with an error of the stance foot: its leg reaches for it.
/// Errors: a pose that the legs cannot reach.
Result<std::map<std::string, double>> SteppingPose(const Step& step, double t, const FootError& error = {});

}  // namespace sinew
