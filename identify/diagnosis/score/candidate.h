// A candidate of the diagnosis: an effect or a discrepancy term, and the points at which it is scored.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "identify/fit_setup.h"
#include "identify/problem.h"

namespace sinew::diagnosis {

struct Candidate {
  std::string effect;  ///< name of the effect or of the discrepancy term
  Level level = Level::kSensor;
  bool known = true;        ///< false: an unknown term
  std::string description;  ///< of a known effect
  std::string revealing_experiment;
  Occurrence occurrence = Occurrence::kOccasional;
  std::string trial;            ///< the only trial that it acts in; empty: all
  std::vector<int> parameters;  ///< the parameters that a refit releases
  /// Values at which some parameters are held while the others are scored, because the prediction does not
  /// depend on them at the null.
  struct Probe {
    std::vector<std::pair<int, double>> at;  ///< empty at the null itself
  };
  std::vector<Probe> probes;  ///< at least one
  /// >= 0: index of a parameter of the model that may change with time within a trial (a fluctuation test,
  /// Zeileis, Hornik 2007). There is no parameter to release then: the column that is scored and fitted is
  /// the parameter's derivative times TimeInTrial, and only if the parameter is free, or if the free ones
  /// compensate a constant change of it.
  int drifting = -1;
  bool beside_causes = false;  ///< DiscrepancyTerm::beside_causes

  /// True for known effects that all trials share: the part of the library that is tried first.
  [[nodiscard]] bool primary() const { return known && trial.empty(); }
};

/// Time from -1 at the begin of a block's trial to 1 at its end [samples].
[[nodiscard]] Vector TimeInTrial(const Block& block);

/// Every effect and discrepancy term none of whose parameters is free already, and a drift of every free base
/// parameter and of every parameter of a shared effect. Parameters that the setup holds stay at their value:
/// an effect is a candidate with its other parameters, if there are any; a term with a held weight is none.
/// Parameters that are held at a probe value are not
/// scored; an effect whose only parameter has probe values is scored by the secant from its null to each of
/// them.
[[nodiscard]] std::vector<Candidate> ListCandidates(const Problem& problem, const FitSetup& base);

/// Parameters of a candidate that are scored at a probe: those that have no probe value there.
[[nodiscard]] std::vector<int> ScoredParameters(const Candidate& candidate, std::size_t probe);

/// True if the candidate is scored by the secant from its null to the probe value.
[[nodiscard]] bool IsScoredBySecant(const Candidate& candidate, std::size_t probe);

}  // namespace sinew::diagnosis
