// Score tests of every candidate on the residual of one fit, without refitting: their whitened columns,
// projected off the columns of the fitted parameters, against the whitened residual (Rao 1948).
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "identify/diagnosis/score/design.h"
#include "identify/statistics/alarm.h"

namespace sinew::diagnosis {

/// The score test of one candidate at one of its probes.
struct Score {
  int candidate = 0;
  int probe = 0;
  std::vector<int> directions;  ///< columns of ScoreTable::directions that it spans
  std::vector<int> columns;     ///< columns of the design that belong to it
  double statistic =
      0;  ///< score statistic: the drop of -2 log-likelihood that a refit is predicted to bring
  double p_value = 1;
  double weight = 1;    ///< of its p-value in the family: its share of the level is 1 / weight
  double searched = 0;  ///< number of parameters chosen by search that are not among its directions
};

struct ScoreTable {
  /// [m x D] whitened, of unit length and orthogonal to the base columns: one per parameter of a known
  /// candidate, the leading principal components of a discrepancy term.
  Matrix directions;
  Vector t;            ///< [D] directions' * whitened residual; standard normal if the model is adequate
  Matrix correlation;  ///< [D x D] directions' * directions
  Vector
      length;  ///< [K] of each design column, whitened and projected off the base; 0 if it is within the base
  Vector kept;  ///< [K] that length as a share of the length before the projection
  Vector
      estimate;  ///< [K] one-parameter estimate for each column, minus its null; 0 if it is within the base
  std::vector<Score> scores;
  std::vector<bool> positive;  ///< [D] true: only t > 0 is possible

  /// Canonical correlation between the spans of two scores, the smallest of the two spans' correlations: 1
  /// only if each direction of the smaller span lies in the other.
  [[nodiscard]] double Correlation(const Score& a, const Score& b) const;
};

/// Score tests of all candidates of the design. @param whitening nullptr: rows are not whitened but scaled
/// per channel so that the residual has unit variance.
ScoreTable MakeScores(const LeastSquares& fit, const Design& design, const std::vector<Candidate>& candidates,
                      const noise::Whitening* whitening);

/// Joint score statistic of several scores: the predicted drop of -2 log-likelihood with all their
/// directions, with the sign constraints of single directions; 0 for none.
[[nodiscard]] double JointStatistic(const ScoreTable& table, const std::vector<const Score*>& scores);

/// The family-wise level of all tests of one score table.
struct Family {
  double level = 0.05;
  double smallest_p = 1;              ///< critical weighted p-value: a score below it is an alarm
  double threshold = 0;               ///< critical |t| of one two-sided direction of weight 1
  double p_value = 1;                 ///< family-wise, of the most significant score
  std::vector<double> score_p_value;  ///< [scores] family-wise
  std::shared_ptr<const statistics::AlarmLevel> alarm;  ///< nullptr if nothing could be scored

  /// Family-wise p-value: probability of any weighted p-value as small as this one if the model is adequate.
  [[nodiscard]] double FamilyPValue(double weighted_p) const;
};
[[nodiscard]] Family FamilyOf(const ScoreTable& table, double level, std::uint64_t seed);

}  // namespace sinew::diagnosis
