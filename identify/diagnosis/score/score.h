// How every candidate answers to the residual of one fit, without refitting: score tests on whitened columns
// from which everything that the fitted parameters can imitate has been taken away.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "identify/diagnosis/score/design.h"
#include "identify/statistics/alarm.h"

namespace sinew::diagnosis {

/// The answer of one candidate at one of its probes.
struct Score {
  int candidate = 0;
  int probe = 0;
  std::vector<int> directions;  ///< columns of ScoreTable::directions that it spans
  std::vector<int> columns;     ///< columns of the design that belong to it
  double statistic = 0;         ///< drop of twice the negative log-likelihood that a refit should bring
  double p_value = 1;
  double weight = 1;    ///< of its p-value in the family: what share of the level it may spend
  double searched = 0;  ///< parameters that were chosen for it without being among its directions
};

struct ScoreTable {
  /// [m x D] orthogonal to the base, unit length, whitened. One per parameter of a known candidate; the
  /// leading principal components of an unknown term.
  Matrix directions;
  Vector t;            ///< [D] directions' * whitened residual; standard normal if nothing is wrong
  Matrix correlation;  ///< [D x D] directions' * directions
  Vector length;       ///< [K] of each column of the design, whitened, base taken away; 0 if nothing is left
  Vector kept;         ///< [K] its share of the length before the base took what it can
  Vector estimate;     ///< [K] of each column's parameter on its own, minus its null; 0 if nothing is left
  std::vector<Score> scores;
  std::vector<bool> positive;  ///< [D] only t > 0 makes sense

  /// Largest |correlation| between the spans of two scores, canonical.
  [[nodiscard]] double Correlation(const Score& a, const Score& b) const;
};

/// @param whitening nullptr: rows as they are, scaled so that the residual has unit variance.
ScoreTable MakeScores(const LeastSquares& fit, const Design& design, const std::vector<Candidate>& candidates,
                      const noise::Whitening* whitening);

/// Drop of twice the negative log-likelihood for the scores' directions together, signs respected for single
/// directions; 0 for none.
[[nodiscard]] double JointStatistic(const ScoreTable& table, const std::vector<const Score*>& scores);

/// One level for everything that could raise an alarm.
struct Family {
  double level = 0.05;
  double smallest_p = 1;              ///< weighted p-value below which a score is an alarm
  double threshold = 0;               ///< |t| of one two-sided direction of weight 1 at `smallest_p`
  double p_value = 1;                 ///< of the strongest score
  std::vector<double> score_p_value;  ///< [scores] family-wise
  std::shared_ptr<const statistics::AlarmLevel> alarm;  ///< nullptr if nothing could be scored

  /// Chance of anything as strong as this weighted p-value, if nothing is wrong.
  [[nodiscard]] double FamilyPValue(double weighted_p) const;
};
[[nodiscard]] Family FamilyOf(const ScoreTable& table, double level, std::uint64_t seed);

}  // namespace sinew::diagnosis
