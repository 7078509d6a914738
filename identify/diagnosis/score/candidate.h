// What may be wrong, as the diagnosis tries it: an effect or an unknown term, and the points at which it is
// probed.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "identify/fit_setup.h"
#include "identify/problem.h"

namespace sinew::diagnosis {

struct Candidate {
  std::string effect;  ///< name of the effect, or of the unknown term
  Level level = Level::kSensor;
  bool known = true;        ///< false: an unknown term
  std::string description;  ///< of a known effect
  std::string revealing_experiment;
  std::string trial;            ///< the trial that alone shows it; empty: all
  std::vector<int> parameters;  ///< what a refit releases
  /// Parameters that mean nothing at the null stand at these values while the others are scored there.
  struct Probe {
    std::vector<std::pair<int, double>> at;  ///< empty at the null itself
  };
  std::vector<Probe> probes;  ///< at least one
  /// >= 0: this parameter, which the model has, may not be constant but change with time within a trial (a
  /// fluctuation test, Zeileis, Hornik 2007). Nothing can be released then: what is scored, and fitted, is
  /// the parameter's derivative times TimeInTrial; and only if the parameter is free.
  int drifting = -1;

  /// Shared by all trials and known: the library proper, which is tried first.
  [[nodiscard]] bool primary() const { return known && trial.empty(); }
};

/// From -1 at the begin of a block's trial to 1 at its end [samples].
[[nodiscard]] Vector TimeInTrial(const Block& block);

/// Every effect and unknown term of which no parameter is free already. Secondary parameters that stand at a
/// probe are not scored; an effect whose only parameter has probes is scored by the change from its null to
/// each of them.
[[nodiscard]] std::vector<Candidate> ListCandidates(const Problem& problem, const FitSetup& base);

/// Parameters of a candidate that are scored at its probes: those that stand at none.
[[nodiscard]] std::vector<int> ScoredParameters(const Candidate& candidate, std::size_t probe);

/// True if the candidate is scored by the change from its null to the probe.
[[nodiscard]] bool IsScoredBySecant(const Candidate& candidate, std::size_t probe);

}  // namespace sinew::diagnosis
