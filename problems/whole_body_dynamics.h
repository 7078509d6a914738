// The recorded motion of a whole body becomes channels: what the ground has to do so that it moves so.
#pragma once

#include <string>
#include <vector>

#include "base/error.h"
#include "datasets/dataset.h"
#include "models/multibody/osim_model.h"

namespace sinew {

/// Names of the channels, each followed by _x, _y or _z.
inline constexpr const char* kWholeBodyForce = "whole_body_load";     ///< [N]
inline constexpr const char* kWholeBodyMoment = "whole_body_torque";  ///< about the origin of ground [N m]
inline constexpr const char* kMassCentre = "mass_centre";             ///< [m]
inline constexpr const char* kDynamicsGrid = "dynamics";

/// One trial's whole-body dynamics.
struct WholeBodyDynamics {
  std::string trial;
  std::size_t frames = 0;
  double mass = 0;                ///< of the model [kg]
  double weight_share = 0;        ///< mean vertical force over the model's weight
  bool kept = false;              ///< a part of a recording that has them already: nothing was done
  std::vector<std::string> held;  ///< coordinates without data that move little mass: at the model's default
};

/// 99.7 % of the power of walking is below it (Winter 2009, Biomechanics and Motor Control of Human Movement,
/// ch. 3.4). Cross-validation is no guide here: errors of inverse kinematics are correlated in time, and it
/// takes them for motion.
inline constexpr double kWalkingCutoff = 6;  ///< [Hz]

/// Adds (or replaces) the grid `dynamics` of every trial that holds coordinates of the model; one that was
/// cut from a recording and has it keeps it, since the recording's has no ends there. Coordinates are
/// low-passed without lag (second order, forwards and backwards), then differentiated twice as splines: a
/// quarter of a second at both ends of a recording is not to be trusted.
/// @param cutoff [Hz] of all coordinates; 0: none
/// @return one per trial with coordinates, in the order of their names; empty if there is none
/// Errors, with the trial: a coordinate without data that moves more than a twentieth of the mass; frames
/// that are not equally spaced, or too few; a gap; a model without masses; a motion so fast or so far away
/// that it cannot be in rad and m. The data set is then unspecified.
Result<std::vector<WholeBodyDynamics>> AddWholeBodyDynamics(const OsimModel& osim, double cutoff,
                                                            Dataset& data);

}  // namespace sinew
