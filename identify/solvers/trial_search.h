// The nuisance values of single trials, whose priors and data have many minima.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "identify/solvers/window_search.h"

namespace sinew::solvers {

/// Fewer nuisance values of a trial are no curve: neither windows nor stretches of time tell of them, and the
/// searches below leave them as they are.
inline constexpr int kFewestOfCurve = 8;

/// Whether a trial that is fitted has a curve of its own.
[[nodiscard]] bool HasCurves(const LeastSquares& fit);

/// One trial: in growing windows (SearchInWindows), then with stretches redrawn (RedrawStretches). Its
/// arguments are theirs.
[[nodiscard]] WindowEnd SearchTrial(LeastSquares& fit, const Vector& start, const std::vector<Vector>& others,
                                    std::uint64_t seed, const std::function<bool()>& stop);

struct TrialSearch {
  std::uint64_t seed = 1;
  int threads = 1;
  bool in_windows = true;      ///< false: only with stretches redrawn
  std::vector<Vector> others;  ///< [n] each, ends of other searches, from which a trial is searched, too
};

/// Of a fit of several trials: the own nuisance values with priors of every trial in turn are searched, the
/// other values held, and the trials put together. @param x [n] @return x, with other values of the trials
/// for which better ones were found [n]
[[nodiscard]] Vector SearchTrials(const LeastSquares& fit, const Vector& x, const TrialSearch& search,
                                  const std::function<bool()>& stop);

/// All trials and what they have in common, together: with stretches redrawn (RedrawStretches). @param end a
/// minimum of the fit @param enough of Redraws
[[nodiscard]] WindowEnd RedrawTrials(const LeastSquares& fit, const WindowEnd& end, std::uint64_t seed,
                                     int threads, double enough, const std::function<bool()>& stop);

}  // namespace sinew::solvers
