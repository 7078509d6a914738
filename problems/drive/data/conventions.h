// Units, signs and zeros of a recording that contradict the motion of any joint.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "models/drive/dynamics.h"
#include "problems/drive/data/motion.h"

namespace sinew {

/// What speaks against the units, signs and zeros that a recording is said to have.
struct DriveConventions {
  /// [s] between samples, if it is far too long for a joint: times in another unit
  std::optional<double> interval;
  /// The input accelerates the joint against its direction and takes more out of it than it puts in (torque,
  /// force, voltage, duty), or what is to follow a reference moves against it.
  bool opposite_input = false;
  /// [rad] what the position's numbers count, where it is not a radian: pi / 180 if they are degrees
  std::optional<double> angle_unit;
  /// [rad] position at which the joint hangs down, if that is neither 0 nor upright
  std::optional<double> hangs_at;
  bool by_gravity = true;  ///< unit or zero are told by the shape of gravity; else a spring would do as well
};

/// Of all trials together. From a force, torque, voltage or duty by least squares in the weak form
/// (weak_form.h) with dry friction, an offset, gravity and a spring beside inertia and damping:
///  - the sign is opposite if the inertia is negative, with a partial correlation beyond -0.7, and the joint
///    takes up no energy while it moves (its command times its speed, over their root mean squares, is below
///    0.02), or beyond -0.3 and it gives energy back (below -0.1);
///  - the unit is another one if gravity in that unit leaves a quarter of the squared residual that gravity
///    and a spring leave in radians; or, of degrees and a joint that seems to turn about one and a half
///    times, a quarter of what gravity alone leaves, and no more than a spring leaves;
///  - gravity has its zero elsewhere if a cosine beside the sine leaves a quarter of the squared residual,
///  and
///    no more than a spring leaves beside the sine.
/// From a reference by its correlation with what it commands, beyond 0.8: its sign, and of measured angles
/// factors between a third and one and a half times that of degrees. The interval is too long from 0.5 s on.
[[nodiscard]] DriveConventions JudgeConventions(const DriveJoint& joint, const DriveCommand& command,
                                                const std::vector<DriveMotion>& motions);

/// A sentence for each, without a full stop, with what to do.
/// @param input its channel
[[nodiscard]] std::vector<std::string> ConventionNotes(const DriveConventions& conventions,
                                                       const std::string& input);

}  // namespace sinew
