// Intervals in the unit box, and the same in the parameter's unit.
#pragma once

#include "base/linear_algebra.h"
#include "identify/least_squares.h"
#include "identify/uncertainty/verdict.h"

namespace sinew::uncertainty {

/// Both ends are given in the unit box; an end on or beyond a bound is cut off there, and open.
/// @param x [n] point that gives all other values
[[nodiscard]] Interval MakeInterval(const LeastSquares& problem, const Vector& x, int variable,
                                    double lower_x, double upper_x);

/// x +- half_width, which may be infinite.
[[nodiscard]] Interval LinearInterval(const LeastSquares& problem, const Vector& x, int variable,
                                      double half_width);

}  // namespace sinew::uncertainty
