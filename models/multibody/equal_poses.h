// Poses of other angles that place every marker alike: whole turns, and joints of three rotations, each of
// whose orientations has two sets of angles. Internal to models/.
#pragma once

#include "models/multibody/inverse_kinematics.h"
#include "models/multibody/marker_fit.h"

namespace sinew {

/// Lower by more than the solver's accuracy leaves open.
bool IsLower(double cost, double than, const IkOptions& options);

/// A free coordinate that is an angle.
bool IsFreeAngle(const MultibodyModel& model, int coordinate);

/// Where an angle is expected [rad]: the middle of its range, the default if the range is wider than four
/// turns or missing. Models give ranges to unclamped coordinates too, and the middle does not depend on the
/// pose with which a search begins.
double ExpectedAngle(const MultibodyModel& model, int coordinate);

/// Sum of squares of the free angles' distances from what is expected [rad2].
double Oddity(const MultibodyModel& model, const Vector& values);

/// Of the poses that place the markers of `fit`'s frame alike the one of the smallest oddity. A pose that is
/// a whole turn off moves to within half a turn of what is expected even where the markers then fit less
/// well: axes that move with an angle (a knee's spline) mean nothing a turn beyond their range.
MarkerFit::Solution Canonical(MarkerFit& fit, const MultibodyModel& model, const IkOptions& options,
                              MarkerFit::Solution solution);

/// The pose of `solution` with angles as near as they can be to those of `neighbour`.
MarkerFit::Solution Continued(MarkerFit& fit, const MultibodyModel& model, const IkOptions& options,
                              MarkerFit::Solution solution, const Vector& neighbour);

/// From `start`; where a clamped range of a whole turn or more ends the search at one of its ends, also from
/// the other end. The lower of the two.
MarkerFit::Solution SolveAcrossEnds(MarkerFit& fit, const MultibodyModel& model, const Vector& start,
                                    const MarkerFit::Search& search);

}  // namespace sinew
