// Motions that a laboratory would ask of a joint to identify it.
#pragma once

#include "base/random.h"
#include "problems/drive/laboratory/simulation.h"

namespace sinew {

/// Six sines between 0.1 and 3 Hz with drawn amplitudes, frequencies and phases, faded in and out within half
/// a second, as torque; scaled so that the joint of `nominal` swings to a drawn angle between 0.6 and 1.4 rad
/// (linear in between: the hanging joint stays clear of the upright). Released at a drawn angle of at most
/// 0.3 rad from rest.
Result<DriveTrial> DrawMultiSine(const DriveTruth& nominal, double duration, double rate, Random& random);

/// The same six sines, scaled so that the largest torque is a drawn multiple, 2 to 4, of the gravity torque
/// of `nominal`: the joint turns over, and its motion passes the upright, near which small differences grow.
DriveTrial DrawOverTheTop(const DriveTruth& nominal, double duration, double rate, Random& random);

/// Moves between drawn angles within +-1.2 rad with trapezoidal speed and short rests, followed by a position
/// controller that is tuned for the joint of `nominal`.
DriveTrial DrawTrapezoid(const DriveTruth& nominal, double duration, double rate, Random& random);

/// The moves of DrawTrapezoid as references of a cascade that is tuned for the joint of `nominal`, 200 ticks
/// per second, limited to three times its gravity torque and what its fastest move takes. @param integral
/// P/PI instead of P/P.
/// @param disturbance [N*m] amplitude of six sines between 0.5 and 3 Hz that are added to its output
DriveTrial DrawCascaded(const DriveTruth& nominal, bool integral, double disturbance, double duration,
                        double rate, Random& random);

/// One more trial that a diagnosis may suggest, each of them to excite what the motions above do not.

/// Zero torque: the joint is released at a drawn angle between 0.1 and 0.3 rad, on a drawn side, swings out
/// and hangs.
DriveTrial DrawRest(double duration, double rate, Random& random);

/// Creeping there and back at four constant speeds from about 0.04 to 0.5 rad/s, the same time each, about a
/// drawn angle within +-0.8 rad, followed by the position controller of DrawTrapezoid.
DriveTrial DrawCreep(const DriveTruth& nominal, double duration, double rate, Random& random);

/// Eight angles held for the same time each, up and down a staircase over about +-1.2 rad, with quick moves
/// in between, by the position controller of DrawTrapezoid.
DriveTrial DrawHold(const DriveTruth& nominal, double duration, double rate, Random& random);

/// Six sines between 0.5 and 3 Hz as torque, scaled so that the joint of `nominal` swings to a drawn angle
/// between 1.9 and 2.2 rad: the fastest that stays clear of the upright. Errors: those of SimulateDrive.
Result<DriveTrial> DrawFast(const DriveTruth& nominal, double duration, double rate, Random& random);

/// Steps of torque between drawn levels, 0.05 to 0.4 s each, scaled so that the joint of `nominal` swings to
/// a drawn angle between 0.6 and 1.2 rad. Meant for a high `rate`: a step takes one sample. Errors: those of
/// SimulateDrive.
Result<DriveTrial> DrawSharp(const DriveTruth& nominal, double duration, double rate, Random& random);

/// Speed reference that runs the range of an ankle orthosis, -20 to +15 deg, back and forth, from 0 deg
/// upwards. @param first, second [rad/s] speeds before and after the middle of the trial.
DriveTrial BackAndForth(double first, double second, double duration, double rate);

}  // namespace sinew
