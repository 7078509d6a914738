// The deviation that a step without a plate is expected to have: the mean of those of other steps.
#pragma once

#include <vector>

#include "problems/contact/stance.h"

namespace sinew {

/// Share of the stance that has passed at an instant, 0..1.
[[nodiscard]] double PhaseOf(const Stance& stance, std::size_t instant);

/// Sets the own weights of a stance so that its own deviation is, at every phase of the stance, the mean of
/// the own deviations of other stances, mirrored where they are of the other foot. With what all stances have
/// in common, which `parameters` hold, that makes its whole deviation their mean: an unbiased prediction,
/// however much of the deviation differs from step to step. (The most probable common part alone is smaller:
/// the prior takes a part of every deviation for that step's own.)
/// @param others not empty @param parameters [P] changed in the stance's own weights only
void SetMeanDeviation(const std::vector<const Stance*>& others, const Stance& stance, Vector& parameters);

}  // namespace sinew
