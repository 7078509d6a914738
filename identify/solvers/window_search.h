// Nuisance values of a single trial, searched in windows of time that grow until they hold the whole trial.
#pragma once

#include <functional>
#include <vector>

#include "identify/least_squares.h"

namespace sinew::solvers {

/// A point of such a search.
struct WindowEnd {
  Vector x;             ///< [n, in 0..1]
  double cost = 0;      ///< there
  double marginal = 0;  ///< MarginalCost there
};

/// Where curves with priors follow precise data through a law with branches (a foot that slides or sticks),
/// all of a trial at once is searched from far away. In a window that grows, each new instant is close to
/// where the curves already point: the estimate is extended like that of a filter, and the branch is the one
/// that continues the motion. Windows grow from both ends of the trial, from its middle and from its
/// quarters, each from the priors' means and from the given point; next to a window residuals count less and
/// less. A search whose window costs more than the best whole trial is given up, since more data only add to
/// that. Of the ends the one with the least MarginalCost is the answer.
///
/// @param fit of one trial, whose free variables are its nuisance values; its transform is removed
/// @param start [n] @param others [n] each: further points to search from, with the whole trial
/// @param stop asked between windows, in any thread: true ends the search early; may be empty
/// @return the start, if nothing has a MarginalCost that is lower by kWorthTaking
/// Source: continuation in the length of the window, as for two-point problems (Keller 1992, Numerical
/// methods for two-point boundary-value problems, ch. 5).
[[nodiscard]] WindowEnd SearchInWindows(LeastSquares& fit, const Vector& start,
                                        const std::vector<Vector>& others, const std::function<bool()>& stop);

/// Difference of two MarginalCosts below which two points are taken for the same.
inline constexpr double kWorthTaking = 0.25;
/// Gain of MarginalCost for which a search goes on: half of what a parameter more usually gains in
/// -2 log likelihood.
inline constexpr double kWorthGoingOn = 1;

}  // namespace sinew::solvers
