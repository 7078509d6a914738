// What the data determine about every fitted parameter: a verdict with its reason, errors, a 95 % interval,
// and what measurement would help.
//
// Assumed: residuals of one channel have one standard deviation, which is Block::sigma where stated and else
// estimated per channel (noise.h). The estimate is the minimum of the cost as it was fitted, with the weights
// of the blocks; its covariance allows for weights that are not one over the noise (covariance.h). The linear
// parts hold at the minimum that a local search finds from the solution; see `minimum`.
#pragma once

#include <atomic>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/linear_algebra.h"
#include "identify/least_squares.h"
#include "identify/uncertainty/competing_minima.h"
#include "identify/uncertainty/noise.h"
#include "identify/uncertainty/reason.h"
#include "identify/uncertainty/verdict.h"
#include "identify/warning.h"

namespace sinew {

/// How a 95 % interval was found.
enum class IntervalKind {
  kProfile,  ///< profile likelihood
  /// estimate +- quantile times error, in the parameter's scale, and what an unfinished profile knows to be
  /// inside; Reason::no_profile is why
  kLinear,
  kNone  ///< the data determine nothing: the interval is the whole range
};

/// "profile", "linear", "none".
[[nodiscard]] const char* ToString(IntervalKind kind);

struct ParameterVerdict {
  int parameter = 0;  ///< index into Problem::parameters()
  double value = 0;   ///< at the solution; all figures in the parameter's unit
  /// For independent residuals, with values that are on a bound held there; infinite if not determined.
  double std_error = 0;
  double std_error_robust = 0;  ///< for heteroskedastic and autocorrelated residuals, see RobustCovariance
  double ci95_lower = 0;
  double ci95_upper = 0;
  bool lower_open = false;  ///< the interval was cut off at the lower bound
  bool upper_open = false;
  IntervalKind interval = IntervalKind::kNone;
  Verdict verdict = Verdict::kNotIdentifiable;
  Reason reason = {};
  Remedy remedy = {};  ///< what measurement would help
};

struct Uncertainty {
  std::vector<ParameterVerdict> parameters;  ///< the free ones that are not nuisance, in the problem's order
  /// Plain covariance [k x k, product of units], k = parameters. Infinite on the diagonal and zero beside it
  /// where nothing is determined; a parameter on a bound is held, and only its own variance is given.
  Matrix covariance;
  Matrix correlation;      ///< [k x k] of it
  Vector singular_values;  ///< of the projected Jacobian with columns of unit length, decreasing, of the
                           ///< inner ones
  std::vector<OpenDirection> directions;         ///< combinations that the data leave open
  std::vector<uncertainty::ChannelNoise> noise;  ///< per fitted channel
  double residual_scale = 0;                     ///< standard deviation of the weighted residuals
  double degrees_of_freedom = 0;                 ///< of the estimated noise; infinite if all levels are known
  Vector minimum;              ///< [P] parameters at the minimum that the intervals are about
  std::vector<Warning> notes;  ///< what limits the intervals
  /// [n, within 0..1] A point of lower cost than the solution that was met by the local search or on the way
  /// to an interval, the lowest one; empty if there was none. A note tells of it, too.
  Vector better_point;
  /// Minima that the data do not distinguish, that of the intervals included, lowest first (one if there is
  /// no other, or none was looked for). Intervals hold the profile intervals of all of them.
  std::vector<LocalMinimum> minima;
  long evaluations = 0;  ///< of the local search and the profiles
};

struct UncertaintyOptions {
  bool profile = true;
  int threads = 1;
  long max_profile_evaluations = 200;            ///< of one end; then its interval is linear (and marked)
  const std::atomic<bool>* interrupt = nullptr;  ///< the remaining intervals are linear (and marked)
  /// Points that were evaluated in the search, from which other minima are looked for; null: none.
  const std::vector<TraceEntry>* points = nullptr;
  long search_evaluations = 0;  ///< of the search, of which the points may be a part; 0: the points are all
};

/// Analyses the solution x [n, within 0..1] of a fit.
///
/// 95 % intervals end where the cost has risen by q^2 / 2 * max(V, R) / G: q is the quantile of Student's t
/// for the degrees of freedom (normal if the noise is known), V and R the plain and the robust variance, G
/// the diagonal of (J'J)^-1. For one channel with independent residuals this is the likelihood ratio against
/// F(1, m - p); scaling it by the variance that the estimate really has keeps it right for other weights and
/// for correlated residuals, which otherwise cover 40 % instead of 95 % at a correlation of 0.8 (Kent 1982;
/// Chandler, Bate 2007). A parameter on a bound keeps its plain variance: the misfit that a bound causes
/// looks like correlated noise, and is none. All ends are searched with every other value free in its whole
/// range, also those that are on a bound at the minimum. Errors: no
/// prediction at x, wrong size of x, nothing fitted.
Result<Uncertainty> AnalyseUncertainty(const LeastSquares& problem, const Vector& x,
                                       const UncertaintyOptions& options);

}  // namespace sinew
