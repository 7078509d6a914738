// Refits in the record of what was done: with the fit, also the estimate of its noise is not repeated.
#pragma once

#include <functional>
#include <vector>

#include "identify/diagnosis/fit/refit.h"

namespace sinew::diagnosis {

/// How a refit is made: ordinary least squares alone, or with a noise model (Refitter::Fit), under which all
/// errors may be taken as independent, or which begins with a given one.
enum class RefitKind { kOrdinary, kGeneralised, kIndependent, kUnderExpectedNoise };

/// The refit from the record of its setup, or `make` and the record; without a record, `make`.
/// @param asked with `released` and `setup`: what the fit is of @param starts [P] each @param make the fit,
/// which must follow from the other arguments alone. One that was interrupted is not kept.
/// @param under the noise model that it begins with; may be null
[[nodiscard]] Refit RecordedRefit(const Problem& problem, Refit asked, RefitKind kind,
                                  const std::vector<Vector>& starts, double tolerance,
                                  const std::function<Refit(Refit)>& make,
                                  const noise::NoiseModel* under = nullptr);

}  // namespace sinew::diagnosis
