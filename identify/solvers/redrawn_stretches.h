// Other minima of curves with priors: in a stretch of time they are redrawn from what the rest says of them.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>

#include "identify/solvers/window_search.h"

namespace sinew::solvers {

struct Redraws {
  std::uint64_t seed = 1;
  int threads = 1;
  int idle = 16;  ///< in a row, after which it ends: none of them gained kWorthGoingOn
  /// It also ends where the MarginalCost falls to this one.
  double enough = -std::numeric_limits<double>::infinity();
};

/// A fit whose curves with priors follow precise data through a law with branches has as many minima as there
/// are stretches of time with a wrong branch. From a minimum, again and again:
///
/// 1. a stretch of a trial is chosen, the more often the larger the residuals there are, and its data are
/// left
///    out; every second time those of the same stretch of all trials;
/// 2. the values are fitted to the rest, and redrawn: at that fit, or from its Gaussian posterior, which
///    leaves them as they are where there are data and follows the priors in the stretch;
/// 3. its data come back from one side, from both sides, or with a noise level that falls, and are given up
///    where that costs more than the minimum;
/// 4. all is fitted. It is the new minimum if its MarginalCost is lower by kWorthTaking.
///
/// Four at a time, of which the best one counts. The answer is the same for the same seed, whatever the
/// number of threads.
/// @param end a minimum of the fit, whose transform is not used @param stop asked between fits, in any
/// thread; may be empty
/// Sources: large neighbourhood search (Shaw 1998, CP98, LNCS 1520:417-431); draws from Laplace's
/// approximation (Tierney, Kadane 1986).
[[nodiscard]] WindowEnd RedrawStretches(const LeastSquares& fit, WindowEnd end, const Redraws& how,
                                        const std::function<bool()>& stop);

}  // namespace sinew::solvers
