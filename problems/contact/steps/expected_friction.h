// A step without its plate: the friction to expect where the slip of the sole is not known.
#pragma once

#include "problems/contact/steps/step_estimate.h"

namespace sinew {

/// Sets the horizontal forces and the free moment of a step, and their standard deviations, to what is
/// expected over the posterior of its own deviations: the mean of 500 pairs of opposite draws from the
/// Gaussian approximation at the most probable ones (Tierney, Kadane 1986), relative to the vertical force of
/// these draws, times the most probable vertical force. Friction turns round with the direction of a slip of
/// millimetres per second, so that its value at the most probable slip is far from its mean, and its linear
/// standard deviation that of an unbounded force. Vertical force and centres of pressure stay. The same on
/// every machine.
/// @param estimate of EstimateStep
/// Errors: those of Problem::Predict at the most probable deviations.
Status TakeExpectedFriction(const ContactProblem& problem, const Stance& stance, StepEstimate& estimate);

}  // namespace sinew
