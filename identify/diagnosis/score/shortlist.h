// Choice of the candidates that are refitted, by their scores alone.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "identify/diagnosis/score/scored_model.h"

namespace sinew::diagnosis {

/// Penalty per parameter in units of deviance: two standard deviations squared.
inline constexpr double kPerParameter = 4;
/// Deviance difference below which two causes count as not distinguishable.
inline constexpr double kSetWidth = 6;
inline constexpr double kSetWidthColoured =
    9;  ///< ... if the noise model is estimated with several coefficients

class Shortlist {
 public:
  /// @param base the base model and its scores. Both arguments must outlive this.
  Shortlist(const std::vector<Candidate>& candidates, const ScoredModel& base);

  /// Known candidates whose score, whitened or not, is close enough to the largest that a refit can put them
  /// first; increasing. Of effects that act in one trial only those of the outlying trial are included: a
  /// sensor that fails in one trial has a much larger score there than in any other, while an effect that is
  /// missing from the library has large scores in several.
  [[nodiscard]] std::vector<int> Singles(const ScoredModel& scored) const;

  /// All known candidates that may be named, whatever their score: where refits contradict the scores.
  [[nodiscard]] std::vector<int> All() const;

  /// Pairs of shared effects with the largest joint statistic at the base model, largest first: two causes
  /// whose scores are large only together, or whose sum is matched by a third.
  [[nodiscard]] std::vector<std::pair<int, int>> Pairs() const;

 private:
  void FindOutlyingTrial();
  [[nodiscard]] bool MayBeNamed(int c) const;

  const std::vector<Candidate>& candidates_;
  const ScoredModel& base_;
  std::string outlying_trial_;
};

}  // namespace sinew::diagnosis
