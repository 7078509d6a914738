// The linearised fit of a diagnosis: residuals, the columns of the fitted parameters, and the columns of all
// candidates.
#pragma once

#include <utility>
#include <vector>

#include "base/error.h"
#include "identify/diagnosis/score/candidate.h"
#include "identify/least_squares.h"
#include "identify/noise/noise_model.h"

namespace sinew::diagnosis {

/// Length of a whitened signature that a test for it alone at the 5 % level detects with probability 95 %:
/// 1.960 + 1.645.
inline constexpr double kDetectableLength = 3.605;

/// One column of a design: the change of the weighted residuals per unit of one parameter of a candidate.
struct DesignColumn {
  int candidate = 0;
  int probe = 0;
  int parameter = 0;
  bool positive = false;  ///< the null is its lower bound, so that only increases are possible
  bool negative = false;  ///< the null is its upper bound, so that only decreases are possible
};

struct Design {
  Vector x;         ///< [n] variables of the fit
  Vector residual;  ///< [m] weighted, rows of the training blocks
  Matrix base;      ///< [m x n] derivatives for the variables of the fit
  /// Variables on a bound beyond which the fit would still improve, and their derivatives [m]: they
  /// compensate nothing, so that their columns of `base` are zero.
  std::vector<std::pair<Eigen::Index, Vector>> at_bound;
  Matrix candidates;                  ///< [m x K] derivatives or secants of the candidates' parameters
  std::vector<DesignColumn> columns;  ///< [K]
};

/// Residuals and the columns of the fitted parameters, as EstimateNoiseModel needs them.
struct NoiseRows {
  std::vector<noise::NoiseBlock> blocks;  ///< [training blocks]
  std::vector<noise::PriorRow> priors;    ///< of fitted parameters
};

/// Errors: those of Problem::Predict at x.
Result<NoiseRows> NoiseRowsAt(const LeastSquares& fit, const Vector& x);

/// Which candidates get columns: those that take part in tests, or also terms that are only fitted beside
/// causes (Candidate::beside_causes).
enum class ScoredCandidates { kTested, kAll };

/// Linearises the fit at x. Candidates that the fit has released already get no columns, nor do those whose
/// prediction fails.
/// @param whitening decides the length of secants: their trace is about as long as the shortest one that a
/// test detects. Errors: those of Problem::Predict at x.
Result<Design> MakeDesign(const LeastSquares& fit, const Vector& x, const std::vector<Candidate>& candidates,
                          const noise::Whitening& whitening, ScoredCandidates which = ScoredCandidates::kAll);

}  // namespace sinew::diagnosis
