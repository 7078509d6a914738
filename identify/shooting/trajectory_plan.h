// Which trials need multiple shooting, and how much of each can be predicted as one trajectory.
#pragma once

#include <string>
#include <vector>

#include "identify/shooting/multiple_shooting.h"
#include "identify/warning.h"

namespace sinew::shooting {

/// How small differences grow from the begin of each window of an arc to its end, in units of TypicalState:
/// [windows but the last] of n x n. @param states [n x windows] Errors: a window cannot be integrated.
Result<std::vector<Matrix>> Transitions(const Model& model, const Arc& arc, const Vector& parameters,
                                        const Matrix& states);

/// The largest factor by which a small difference grows between the begins of any two windows.
[[nodiscard]] double LargestGrowth(const std::vector<Matrix>& transitions);

/// Joins neighbouring windows as long as differences grow by no more than `growth` in between, and at most
/// `most` of them. @return the windows at which one begins, 0 first
[[nodiscard]] std::vector<std::size_t> Join(const std::vector<Matrix>& transitions, double growth,
                                            std::size_t most);

struct PlanOptions {
  /// Of one trajectory: rounding and the integrator's error, times this, stay far below the noise.
  double max_growth = 1e7;
};

/// The trajectories of all trials.
struct Plan {
  bool needed = false;         ///< small differences grow so much that a search could get lost
  double growth = 1;           ///< the largest over any trial, along the measured states
  std::vector<Arc> arcs;       ///< by trial, then in time: one trajectory each
  std::vector<Matrix> states;  ///< [arcs] of n x windows
  Vector parameters;           ///< [P] found from the training trials
  double residual_rms = 0;     ///< of these, weighted
};

/// Finds out how small differences grow along the measured states. If they grow by a factor of more than 30,
/// parameters and states are sought by multiple shooting, of the trials to train on together, then of each
/// other trial its states alone. A trajectory is as long as `max_growth` allows, or shorter where the model,
/// with whatever is wrong with it, does not stay near the measurement over such a length.
/// @param train [trials] @param all, free, parameters as for Solve
/// If anything cannot be integrated, nothing is planned.
Plan MakePlan(const Model& model, const std::vector<bool>& train, const std::vector<Parameter>& all,
              const std::vector<int>& free, const Vector& parameters, const PlanOptions& options);

/// The warning about a trial that is not one trajectory; its facts are the trial and the time of each new
/// begin. @param times [s] at which one begins anew
[[nodiscard]] Warning CutWarning(const std::string& trial, const std::vector<double>& times);

/// Parameters and states of a plan once more: after the integration became finer.
Status Refine(const Model& model, const std::vector<bool>& train, const std::vector<Parameter>& all,
              const std::vector<int>& free, Plan& plan);

}  // namespace sinew::shooting
