// Where a local fit begins if the problem offers a better start than the given values: multiple shooting.
#pragma once

#include <optional>

#include "identify/execution/evaluator.h"
#include "identify/least_squares.h"

namespace sinew::solvers {

/// Problem::ImprovedStart for the free parameters and training blocks of a fit. @param parameters [P] within
/// the fit's bounds @return [P] within them; nothing if the problem has none
[[nodiscard]] std::optional<Vector> ImprovedStart(const LeastSquares& fit, const Vector& parameters);

/// The start of a fit, or the problem's improved one if its cost is lower, and from there the ProbedStart of
/// released effects, whose points on the way the evaluator records. @return [n]
[[nodiscard]] Vector BestStart(Evaluator& evaluator);

}  // namespace sinew::solvers
