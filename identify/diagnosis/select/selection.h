// Steps 3 to 5: which candidates explain what is wrong, and which others these data cannot tell from them.
#pragma once

#include <string>
#include <vector>

#include "identify/diagnosis/diagnosis.h"
#include "identify/diagnosis/score/scored_model.h"

namespace sinew::diagnosis {

/// A candidate that could stand in place of a chosen cause.
struct Rival {
  int candidate = 0;
  int instead_of = 0;      ///< a chosen candidate
  Refit refit;             ///< of the chosen set with this one in place
  double delta_lr = 0;     ///< by which the chosen set fits better
  double correlation = 0;  ///< of the two signatures, base taken away
};

/// Twice the log-likelihood, and its price in parameters, by which a rival may fit worse than this model.
[[nodiscard]] double SetWidth(const Refit& model);

struct ChosenCause {
  int candidate = 0;
  double delta_lr = 0;  ///< against the chosen set without it
  double p_value = 1;   ///< family-wise
  double left_out = 0;  ///< Selection::gross: error of left-out trials with it, as a share of that without
};

struct Selection {
  bool alarm = false;
  /// What is wrong dwarfs the noise, and something of that kind is left: causes were chosen by what they
  /// predict for trials left out of the fit, not by likelihood.
  bool cross_validated = false;
  std::vector<std::vector<std::string>> left_out;  ///< groups of trials, if cross_validated
  std::size_t searched = 0;                        ///< of the training trials, if gross
  double family_p_value = 1;
  std::vector<ChosenCause> causes;  ///< most important first
  std::vector<Rival> rivals;
  std::vector<Refit> tried;     ///< every model with one candidate released, for the table of scores
  Refit model;                  ///< with all causes; the base model if there are none
  bool structure_left = false;  ///< something is wrong still, and no known candidate explains it
  bool line_left = false;       ///< something periodic in time
  std::vector<int> unknown;     ///< unknown terms that answer to what is left, strongest first
  std::vector<double> unknown_p_value;
};

/// @param base the base model. Errors: the problem's own.
Result<Selection> Select(const Problem& problem, const Refitter& refitter,
                         const std::vector<Candidate>& candidates, const ScoredModel& base,
                         const DiagnosisOptions& options);

}  // namespace sinew::diagnosis
