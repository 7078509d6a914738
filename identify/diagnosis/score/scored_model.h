// A fitted model with the score tests of everything that it does not contain.
#pragma once

#include <vector>

#include "identify/diagnosis/fit/refit.h"
#include "identify/diagnosis/score/score.h"
#include "identify/noise/spectral_line.h"

namespace sinew::diagnosis {

struct ScoredModel {
  Refit refit;
  Design design;
  noise::NoiseModel noise;  ///< estimated with the leading directions of all candidates as regressors
  ScoreTable whitened;      ///< scores whitened by that noise
  ScoreTable plain;         ///< scores without whitening, which absorbs large effects
  Family family;
  std::optional<noise::SpectralLine> line;  ///< strongest line of the residual's spectrum, significant or not
  /// Family-wise p-value of the most significant score or of the spectral line, to which a twentieth of the
  /// level is assigned.
  [[nodiscard]] double AlarmPValue() const;

  /// Largest score statistic of a candidate over its probes, nullptr if it was not judged.
  [[nodiscard]] const Score* BestOf(int candidate, const ScoreTable& table) const;
  [[nodiscard]] const Score* BestOf(int candidate) const { return BestOf(candidate, whitened); }
};

/// Scores candidates at the point of a refit. Errors: those of Problem::Predict there. @pre
/// refit.usable()
Result<ScoredModel> ScoreModel(const Problem& problem, const std::vector<Candidate>& candidates, Refit refit,
                               double level, std::uint64_t seed,
                               ScoredCandidates which = ScoredCandidates::kTested);

/// Start points for a refit with `candidate` released: its linear estimate at the probe with the largest
/// statistic, whitened and not; if the statistic is large, at all probes and several sizes, because a local
/// search from the null then ends in local minima. Never empty.
[[nodiscard]] std::vector<Vector> RefitStarts(const ScoredModel& scored,
                                              const std::vector<Candidate>& candidates, int candidate);

}  // namespace sinew::diagnosis
