// Nuisance parameters of held-out trials (initial states, offsets): fitted to these trials, with all other
// parameters fixed.
#pragma once

#include <vector>

#include "base/error.h"
#include "identify/execution/fit_record.h"
#include "identify/problem.h"

namespace sinew::solvers {

/// How nuisance values with priors are searched; such trials have many minima (SearchInWindows).
struct HeldOutSearch {
  /// Also in growing windows. Else the search is local, for values that were fitted to these data before.
  bool in_windows = false;
  /// [P] each, answers for other values of the shared parameters. Their nuisance values are further starts;
  /// where a trial costs more than with the best of them, that answer is followed while the shared parameters
  /// change to the given ones: two models whose fits of a trial end at different minima cannot be compared.
  std::vector<Vector> earlier;
  /// The given nuisance values are fitted: only others that cost less by kWorthTaking replace them.
  bool fitted = false;
  double tolerance = 1e-9;  ///< relative, of a trial's cost
  int threads = 1;
};

/// The parameters [P] with the nuisance parameters of every held-out trial fitted to that trial alone, all
/// others as given. A held-out trial whose fit fails keeps its given values. The answer does not depend on
/// the number of threads. @param parameters [P] @param record of FitSetup, may be null
[[nodiscard]] Vector FitHeldOutNuisance(const Problem& problem, const Vector& parameters, FitRecord* record,
                                        const HeldOutSearch& search = {});

}  // namespace sinew::solvers
