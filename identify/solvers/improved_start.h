// Where a local fit begins if the problem offers a better start than the given values: multiple shooting.
#pragma once

#include <functional>
#include <optional>

#include "identify/least_squares.h"

namespace sinew::solvers {

/// Problem::ImprovedStart for the free parameters and training blocks of a fit. @param parameters [P] within
/// the fit's bounds @return [P] within them; nothing if the problem has none
[[nodiscard]] std::optional<Vector> ImprovedStart(const LeastSquares& fit, const Vector& parameters);

/// The start of a fit, or the problem's improved one if its cost is lower, and from there the ProbedStart of
/// released effects. @param stop whether to end early @return [n]
[[nodiscard]] Vector BestStart(const LeastSquares& fit, const std::function<bool()>& stop);

}  // namespace sinew::solvers
