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
  /// Largest gap between two windows, in units of what the samples of a window resolve.
  double largest_gap = 0;
  /// [arcs] Root mean square of an arc's residual, as a share of what a change of the typical state at the
  /// begins of its windows does to it: far below 1 while predictions stay near the measurement.
  std::vector<double> misfit;
  std::vector<double> free_misfit;  ///< [arcs] the same while the windows were not joined yet
  double residual_rms = 0;          ///< of all residuals, weighted
};

/// Each step of the search is the Gauss-Newton step with Levenberg's damping of residuals and gaps together.
/// States are eliminated window by window with orthogonal transformations, so that neither the number of
/// windows nor the growth of small differences limits it.
/// @param all [P] descriptors: bounds and scale of the free parameters @param free indices, increasing;
/// without those of states, which are the solution's `states`
/// @param parameters [P] where to begin
/// Errors: a window cannot be integrated at the begin.
Result<Solution> Solve(const Model& model, const std::vector<Arc>& arcs, const std::vector<Parameter>& all,
                       const std::vector<int>& free, const Vector& parameters);

/// States at the begins of all windows [arcs] of n x windows: the measured ones; components that are not
/// measured follow the model from window to window, corrected by what each window's samples say.
/// Errors: a window cannot be integrated.
Result<std::vector<Matrix>> TrackedStates(const Model& model, const std::vector<Arc>& arcs,
                                          const Vector& parameters);

}  // namespace sinew::shooting
