// Multiple shooting: parameters and trajectories of a model that is integrated, found together from states at
// the begins of short windows, which are then joined.
//
// Over a short window a trajectory is nearly linear in state and parameters, however fast small differences
// grow over the whole trial; and the states are known about from the measurement. Continuity between windows
// is a penalty that rises until nothing of the gaps is left. Source: Bock, Recent advances in
// parameteridentification techniques for O.D.E., in: Numerical Treatment of Inverse Problems in Differential
// and Integral Equations (1983); Voss, Timmer, Kurths, Nonlinear dynamical system identification from
// uncertain and indirect measurements, Int. J. Bifurcation Chaos 14 (2004).
#pragma once

#include <vector>

#include "base/error.h"
#include "base/linear_algebra.h"
#include "identify/parameter.h"
#include "identify/shooting/shooting_model.h"

namespace sinew::shooting {

struct Solution {
  Vector parameters;           ///< [P] the free ones changed
  std::vector<Matrix> states;  ///< [arcs] of n x windows
  double cost = 0;             ///< half the sum of squared residuals
  double free_cost = 0;        ///< the same while the windows were not joined yet
  /// Largest gap between two windows, in units of what the samples of a window resolve.
  double largest_gap = 0;
  /// [arcs] Root mean square of an arc's residual, as a share of what a change of the typical state at the
  /// begins of its windows does to it: far below 1 while predictions stay near the measurement.
  std::vector<double> misfit;
  double residual_rms = 0;  ///< of all residuals, weighted
};

/// Each step of the search is the Gauss-Newton step with Levenberg's damping of residuals and gaps together.
/// States are eliminated window by window with orthogonal transformations, so that neither the number of
/// windows nor the growth of small differences limits it.
/// @param all [P] descriptors: bounds and scale of the free parameters @param free indices, increasing;
/// without those of states, which are the solution's `states`
/// @param parameters [P] where to begin
/// Errors: a window cannot be integrated at the begin.
Result<Solution> Solve(const Model& model, const std::vector<Parameter>& all, const std::vector<int>& free,
                       const Vector& parameters);

/// How small differences grow from the begin of each window to its end, in units of TypicalState:
/// [arcs][windows but the last] of n x n. @param states [arcs] of n x windows, as a Solution has them, or
/// empty: the measured ones. Errors: a window cannot be integrated.
Result<std::vector<std::vector<Matrix>>> Transitions(const Model& model, const Vector& parameters,
                                                     const std::vector<Matrix>& states);

/// The largest factor by which a small difference grows between the begins of any two windows.
[[nodiscard]] double LargestGrowth(const std::vector<Matrix>& transitions);

/// Joins neighbouring windows as long as differences grow by no more than `growth` in between, and at most
/// `most` of them. @return the windows at which one begins, 0 first
[[nodiscard]] std::vector<std::size_t> Join(const std::vector<Matrix>& transitions, double growth,
                                            std::size_t most);

}  // namespace sinew::shooting
