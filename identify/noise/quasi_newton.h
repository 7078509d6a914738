// A minimiser for smooth functions of a few variables that cost microseconds.
#pragma once

#include <functional>

#include "base/linear_algebra.h"

namespace sinew::noise {

/// A function of x and, if asked for, its gradient [n].
using SmoothFunction = std::function<double(const Vector& x, Vector* gradient)>;

/// BFGS (Nocedal, Wright 2006, algorithm 6.1) with a backtracking line search that halves the step. Variables
/// are expected to be of order one. Stops when the predicted decrease is below `tolerance`, when no step
/// decreases the function, or after 100 iterations.
/// @param x [n] start, then the minimum @param curvature [n] > 0 rough second derivatives, for the first step
/// @return the function at x
double MinimizeSmooth(const SmoothFunction& function, const Vector& curvature, double tolerance, Vector& x);

}  // namespace sinew::noise
