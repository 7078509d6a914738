// Where a diagnosis stands: a fitted model, and how everything that it does not contain answers to its
// residual.
#pragma once

#include <vector>

#include "identify/diagnosis/fit/refit.h"
#include "identify/diagnosis/score/score.h"
#include "identify/noise/spectral_line.h"

namespace sinew::diagnosis {

struct ScoredModel {
  Refit refit;
  Design design;
  noise::NoiseModel noise;  ///< with everything that candidates can do among the regressors
  ScoreTable whitened;      ///< by that noise
  ScoreTable plain;         ///< without whitening, which swallows what is large
  Family family;
  std::optional<noise::SpectralLine> line;  ///< strongest in the residual, whether it means something or not
  /// Chance of any alarm as strong, by scores or by the line, which has a small share of the level.
  [[nodiscard]] double AlarmPValue() const;

  /// Best score of a candidate over its probes, nullptr if it was not judged.
  [[nodiscard]] const Score* BestOf(int candidate, const ScoreTable& table) const;
  [[nodiscard]] const Score* BestOf(int candidate) const { return BestOf(candidate, whitened); }
};

/// Errors: the problem's own at the refit's point. @pre refit.usable()
Result<ScoredModel> ScoreModel(const Problem& problem, const std::vector<Candidate>& candidates, Refit refit,
                               double level, std::uint64_t seed);

/// Points from which a refit with `candidate` released should start: its estimate at the probe that answers
/// best, whitened and not; at all probes and several sizes if what is wrong is large, where a local search
/// from the null alone gets stuck. Never empty.
[[nodiscard]] std::vector<Vector> RefitStarts(const ScoredModel& scored,
                                              const std::vector<Candidate>& candidates, int candidate);

}  // namespace sinew::diagnosis
