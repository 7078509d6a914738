// Which candidates are worth a refit: by their scores alone.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "identify/diagnosis/score/scored_model.h"

namespace sinew::diagnosis {

/// Price of a parameter in units of deviance: two standard deviations.
inline constexpr double kPerParameter = 4;
/// Units of deviance within which causes count as not told apart.
inline constexpr double kSetWidth = 6;
inline constexpr double kSetWidthColoured = 9;  ///< ... if the noise model itself is a guess

class Shortlist {
 public:
  /// @param base where the base model stands. Both must outlive this.
  Shortlist(const std::vector<Candidate>& candidates, const ScoredModel& base);

  /// Known candidates whose score, whitened or not, is so near the best that a refit may put them first,
  /// increasing. Of those that concern one trial alone only the trial that stands out: a sensor that fails in
  /// one trial answers there much more than in any other, while an effect that is not in the library answers
  /// in several.
  [[nodiscard]] std::vector<int> Singles(const ScoredModel& scored) const;

  /// Pairs of shared effects that the linear analysis at the base model likes best, best first: two causes
  /// that only show together, or of which a third imitates the sum.
  [[nodiscard]] std::vector<std::pair<int, int>> Pairs() const;

 private:
  void FindOutlyingTrial();
  [[nodiscard]] bool MayBeNamed(int c) const;

  const std::vector<Candidate>& candidates_;
  const ScoredModel& base_;
  std::string outlying_trial_;
};

}  // namespace sinew::diagnosis
