// Other minima of the cost that the data do not distinguish from the best one.
#pragma once

#include <atomic>
#include <vector>

#include "base/linear_algebra.h"
#include "identify/execution/evaluator.h"
#include "identify/least_squares.h"

namespace sinew {

/// A local minimum of the cost.
struct LocalMinimum {
  double cost = 0;
  Vector x;  ///< [n] unit box
};

}  // namespace sinew

namespace sinew::uncertainty {

/// Where other minima are looked for, and which of them count.
struct CompetitionQuestion {
  const LocalMinimum& best;
  double rise = 0;  ///< of the cost, up to which the data do not exclude a minimum, > 0
  Vector width;     ///< [n] of the intervals, unit box; 0: the variable does not tell minima apart
  const std::vector<TraceEntry>& points;  ///< that the search has evaluated
  const std::vector<Vector>& ends;        ///< [n] each, ends of the intervals by the linear model
  double penalty = 0;                     ///< that of solvers::LocalFit
  int threads = 1;
  const std::atomic<bool>* interrupt = nullptr;
  long search_evaluations = 0;  ///< 0: as many as points
};

/// Minima that are nearer than this share of an interval are the same.
inline constexpr double kSameShare = 0.1;

/// Local searches from points that are not much worse than the best minimum: those of the search, and what
/// short searches from the ends of the intervals reach; one of each group of neighbours, the lowest. At most
/// as many evaluations as the search has used.
/// @return the different minima within the limit, lowest first; `best` is one of them, or a lower point in
/// its neighbourhood @param evaluations is added to
[[nodiscard]] std::vector<LocalMinimum> CompetingMinima(const LeastSquares& problem,
                                                        const CompetitionQuestion& question,
                                                        long& evaluations);

/// Largest difference of two points, in widths.
[[nodiscard]] double DistanceInWidths(const Vector& a, const Vector& b, const Vector& width);

}  // namespace sinew::uncertainty
