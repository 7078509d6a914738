// Parameters of priors, such as how smooth the errors of a recorded motion are, chosen by the marginal
// likelihood of the data.
#pragma once

#include <atomic>

#include "identify/fit_setup.h"
#include "identify/problem.h"

namespace sinew::solvers {

struct PriorChoiceOptions {
  const std::atomic<bool>* interrupt = nullptr;  ///< ends the search: the best values so far
};

struct PriorChoice {
  FitSetup setup;             ///< with the chosen values, and what was fitted with them, in `rest`
  double marginal = 0;        ///< MarginalCost there
  double at_start = 0;        ///< and at the start values
  long evaluations = 0;       ///< of the fit, all searches together
  bool any_chosen = false;    ///< false: nothing to choose, no fit to choose by, or interrupted at once
  bool undetermined = false;  ///< no fit to choose by
};

/// Chooses the parameters of priors (ParameterKind::kPrior) that have other starts and are not held. No least
/// squares can: the cost falls for ever with a prior that allows more. The marginal likelihood does not,
/// because the share of the curves' volume that the data leave falls as well (MarginalCost).
///
/// 1. A search by `continuation` at the start values;
/// 2. from there a pattern search over the logarithms of the values, by steps of the ratio between the start
///    and its first other start, which are halved twice. Each trial carries the last best point over
///    (Problem::AtPriors), fits everything from there and compares the MarginalCosts; at the noise only
///    where the linear model predicts a gain (PredictMinimum), as far as it can be trusted. Again from what
///    was chosen, until nothing moves, and from another search by `continuation` there if that ends in a
///    better minimum.
/// 3. A wrong minimum wants another prior. Where the search by `continuation` at what was chosen does not end
///    in the same minimum, the same from the first other starts (priors that allow less), if the search there
///    ends at a more probable point. While much more than noise is left (NearNoiseCost), the same from there
///    in any case, from the last other starts (priors that allow more), and from a search with temporary
///    priors on the shared parameters.
/// 4. Where the best of these costs more than one and a half times that, it is no fit that could tell of a
///    prior: the last other starts are taken, and all other values stay where they began.
///
/// Source: Rasmussen, Williams (2006), Gaussian Processes for Machine Learning, ch. 5.4.1 (type II maximum
/// likelihood).
[[nodiscard]] PriorChoice ChoosePriors(const Problem& problem, const FitSetup& setup,
                                       const PriorChoiceOptions& options);

/// The setup, all values of which stay but the parameters of priors: they are those of `chosen`.
[[nodiscard]] FitSetup WithPriorsOf(const FitSetup& chosen, FitSetup setup);

}  // namespace sinew::solvers
