// Profile likelihood: how far one value can move, all others refitted, before the fit becomes worse than
// noise allows.
#pragma once

#include <atomic>
#include <vector>

#include "base/linear_algebra.h"
#include "identify/least_squares.h"

namespace sinew {

/// Why the end of an interval was not found.
enum class ProfileFailure {
  kNone,
  kInterrupted,
  kBudgetSpent,        ///< its evaluations were used up
  kRefitNotConverged,  ///< of the other values
  kNoPrediction,       ///< at the end
  kRoughCost           ///< the search did not close in on the end
};

/// "" (none), "interrupted", "budget_spent", "refit_not_converged", "no_prediction", "rough_cost".
[[nodiscard]] const char* ToString(ProfileFailure failure);

/// One end of an interval.
struct ProfileEnd {
  double x = 0;  ///< unit box; of an end that was not found, the farthest value that is known to be inside
  bool open = false;  ///< the bound was reached before the cost rose enough
  ProfileFailure failure = ProfileFailure::kNone;
};

}  // namespace sinew

namespace sinew::uncertainty {

/// One parameter to be profiled.
struct ProfileRequest {
  int variable = 0;
  double rise = 0;  ///< of the cost at which the interval ends, > 0
  double step = 0;  ///< half-width of the linear interval, unit box, > 0
  Vector tangent;   ///< [n] how all variables move per unit of this one, to first order
};

/// The lowest cost that was met, and where.
struct LowestCost {
  double cost = 0;
  Vector x;  ///< [n] empty: none below the minimum's
};

struct Profile {
  ProfileEnd lower;
  ProfileEnd upper;
  LowestCost lowest;  ///< below the minimum's if the fit was not at its best
};

struct ProfileOptions {
  int threads = 1;
  long max_evaluations = 200;                    ///< for each end
  double penalty = 0;                            ///< that of solvers::LocalFit
  const std::atomic<bool>* interrupt = nullptr;  ///< ends every search that still runs
};

/// Both ends of every request: by Gauss-Newton models (profile_end.h), and where these do not converge by the
/// roots of sqrt(rise so far / rise) = 1, which is linear for a linear model: bracket, then Illinois steps
/// (Dowell, Jarratt 1971), every point with all other variables refitted, nuisance included. A point without
/// a prediction counts as an infinite rise; if the end then lies at such a place, that is its failure. The
/// answer does not depend on the number of threads.
/// @param minimum [n] @param cost there (of solvers::LocalFit) @param evaluations is added to.
[[nodiscard]] std::vector<Profile> ProfileIntervals(const LeastSquares& problem, const Vector& minimum,
                                                    double cost, const std::vector<ProfileRequest>& requests,
                                                    const ProfileOptions& options, long& evaluations);

}  // namespace sinew::uncertainty
