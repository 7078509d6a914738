// What the steps of a diagnosis share: the problem, what may be wrong with it, where the base model stands
// and what was chosen. Each step reads it and adds its part.
#pragma once

#include <map>
#include <memory>
#include <vector>

#include "identify/diagnosis/diagnosis.h"
#include "identify/diagnosis/held_out_gain.h"
#include "identify/diagnosis/select/selection.h"

namespace sinew::diagnosis {

struct Examination {
  Examination(const Problem& of, const DiagnosisOptions& how) : problem(of), options(how), held_out(of) {}

  const Problem& problem;
  const DiagnosisOptions& options;
  HeldOut held_out;
  std::vector<Candidate> candidates;
  std::unique_ptr<Refitter> refitter;
  ScoredModel base;
  Selection selection;
  /// Weighted residuals [block of the layout -> samples] of the extended model where something was added that
  /// no parameter holds, such as a drift.
  std::map<int, Vector> added;

  [[nodiscard]] const Candidate& candidate(int c) const { return candidates[static_cast<std::size_t>(c)]; }

  /// Of held-out residuals: in units of the noise, or, if what is wrong dwarfs it, plain squares.
  [[nodiscard]] double Loss(const std::vector<Vector>& residuals, const noise::NoiseModel& noise) const;

  /// Under the refit's noise, or, if what is wrong dwarfs it, by leaving out trials. As Refitter::Covariance.
  [[nodiscard]] Result<Matrix> CovarianceOf(const Refit& refit) const;

  /// By the rules that chose the causes. @param starts [P] each, not empty
  [[nodiscard]] Refit Fit(const std::vector<int>& released, const std::vector<Vector>& starts) const;
};

}  // namespace sinew::diagnosis
