// Steps 3 to 5: the candidates that explain the error, and the alternatives that these data cannot
// distinguish from them.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "identify/diagnosis/diagnosis.h"
#include "identify/diagnosis/fit/folds.h"
#include "identify/diagnosis/score/scored_model.h"
#include "identify/diagnosis/select/free_terms.h"
#include "identify/diagnosis/select/rivals.h"

namespace sinew::diagnosis {

struct ChosenCause {
  int candidate = 0;
  double delta_lr = 0;  ///< likelihood ratio against the chosen set without it
  double p_value = 1;   ///< family-wise
  double left_out = 0;  ///< if Selection::cross_validated: error of left-out trials with it / without it
};

/// A set of causes that cross-validation could have chosen.
struct ResampledSet {
  std::vector<int> released;
  Vector point;      ///< [P]
  double share = 0;  ///< of the resamples of the folds in which it is chosen
};

/// A set of causes that the search by cross-validation has judged.
struct JudgedShare {
  std::vector<int> released;
  double share = 0;  ///< error of left-out data over that of the base model
};

struct Selection {
  bool alarm = false;
  /// The misfit dominates the noise, also with the causes: these were chosen by cross-validation over trials,
  /// not by likelihood.
  bool cross_validated = false;
  /// Several causes, by cross-validation, that leave no more than noise: the steps by likelihood went on from
  /// them.
  bool found_by_search = false;
  std::vector<Fold> left_out;                         ///< in turn, if cross_validated
  std::vector<LadderStep> ladder;                     ///< if cross_validated
  std::vector<ResampledSet> resampled;                ///< if cross_validated, with a share > 0 ...
  std::vector<std::pair<int, double>> chosen_shares;  ///< ... and the share of each candidate in them
  std::vector<JudgedShare> judged;                    ///< if cross_validated
  std::size_t searched = 0;                           ///< of the training trials, if cross_validated
  double family_p_value = 1;
  std::vector<ChosenCause> causes;  ///< most important first
  std::vector<Rival> rivals;
  std::vector<Refit> tried;     ///< every model with one candidate released, for the table of scores
  Refit model;                  ///< with all causes; the base model if there are none
  bool structure_left = false;  ///< an error remains that no known candidate explains
  bool line_left = false;       ///< the remaining residual has a spectral line
  /// A term that stands for no cause, if it explains the error better than the causes.
  std::optional<FreeTermComparison> better_term;
  /// Share of the gain that the causes should bring in held-out trials and do not, beyond chance; structure
  /// is left then. 0: none.
  double held_out_shortfall = 0;
  std::vector<int>
      unknown;  ///< discrepancy terms that are significant in the remaining residual, most significant first
  std::vector<double> unknown_p_value;
  /// Unknown terms that cross-validation has chosen: `model` and the rivals contain them ...
  std::vector<int> terms;
  std::vector<int> imitations;                     ///< ... causes that are not needed beside them ...
  std::shared_ptr<const Selection> without_terms;  ///< ... the selection without them ...
  std::shared_ptr<const Refitter> refitter;        ///< ... and what fits models with them
};

/// Selects the causes: the smallest set of known candidates that explains the error of the base model.
///
/// 1. Alarm: nothing is selected if the family-wise p-value of the base model's scores is above
/// DiagnosisOptions::alarm_level, unless its noise model is so strongly autocorrelated that it can hide an
/// effect; refits decide then.
/// 2. If the misfit dominates the noise: CrossValidatedSearch. Its result is final if more than noise is left
/// with the causes that it finds, and contains unknown terms if left-out data need them; else the next steps
/// start from several such causes, or from the base model if it found only one.
/// 3. Forward: the shortlist of candidates by score (Shortlist; at the first step also pairs) is refitted,
/// and the best is added if it is significant by likelihood ratio. Repeated with scores of the extended
/// model, at a level of 0.02.
/// 4. Backward: causes whose likelihood ratio is below their penalty are removed. If one discrepancy term
/// fits better than all causes together, no cause is named: the cause is then not in the library.
/// 5. Rivals: every cause is replaced by each candidate that could explain the same, pairs by pairs, and all
/// causes by the sets that would do the same (FindImitatingSets). A rival that fits better, or as well
/// (kByOccurrence) and is more common, replaces the cause, such a set all of them, at most 8 times; one whose
/// penalised deviance is within SetWidth is reported as an alternative.
/// 6. The causes together must explain the error at least as well as the best free term, each at its price
/// (CompareWithFreeTerms). If not, they are kept as what resembles the error most, with better_term and
/// structure_left set: the error is not explained.
/// 7. The scores of the final model: what remains is reported in structure_left, line_left and unknown.
///
/// @param problem the problem, of which only training trials are used
/// @param refitter fits all models that are compared; its candidates must be `candidates`. After a search it
/// is told the noise of the inputs that is left (Refitter::ExpectInputNoise)
/// @param candidates all candidates; indices in the result refer to it
/// @param base the fitted base model with its scores at DiagnosisOptions::alarm_level
/// @param options seed, threads, interrupt and alarm level. The result does not depend on the number of
/// threads.
/// @return the selection; without an alarm its `model` is the base model. Errors: those of Problem::Predict.
/// Refits that fail are left out and are no error.
Result<Selection> Select(const Problem& problem, Refitter& refitter, const std::vector<Candidate>& candidates,
                         const ScoredModel& base, const DiagnosisOptions& options);

}  // namespace sinew::diagnosis
