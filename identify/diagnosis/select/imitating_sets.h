// Sets of effects that would do together what the causes of a model do together: a spring and an offset
// beside a load that does not hang straight and a ripple of a long period. Exchanging one cause at a time
// need not lead from the one set to the other.
#pragma once

#include <map>
#include <vector>

#include "base/error.h"
#include "identify/diagnosis/fit/refit.h"
#include "identify/diagnosis/score/candidate.h"

namespace sinew::diagnosis {

/// Regression of what the causes of a model change in the data, and of its residual, on the columns of the
/// candidates, at the model's own trajectory, where a misfit is small whatever the causes are called (all
/// subsets regression: Furnival, Wilson 1974, Technometrics 16:499-511). All pairs are tried, larger sets by
/// extending the best 24. A set has at most as many members as the model has causes, is not a part of them,
/// and differs from them in more than one member; the first order of what it leaves must be less than 2 % of
/// the square of what the causes change.
///
/// @param model fitted, with two causes or more; else there are none
/// @param nulls [P] where candidates do nothing: the point of the base model
/// @return at most six sets, those that are predicted to fit best at their price (kPerParameter), each with
/// the points [P] from which to fit it. Errors: those of Problem::Predict at the model's point.
[[nodiscard]] Result<std::map<std::vector<int>, std::vector<Vector>>> FindImitatingSets(
    const Problem& problem, const std::vector<Candidate>& candidates, const Refit& model,
    const Vector& nulls);

}  // namespace sinew::diagnosis
