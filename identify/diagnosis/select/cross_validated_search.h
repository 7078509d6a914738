// Selection by cross-validation, for misfits that dominate the noise: a noise model then absorbs the misfit,
// and likelihoods say little. A set of causes is judged by its prediction of data that were left out of the
// fit (Stone 1974, J. R. Stat. Soc. B 36:111-147): trials, or windows of time where there are few trials.
// Several sets are extended at a time (beam search), because a cause may improve the prediction only once
// another one is included. The error of a set is the geometric mean of the errors of the folds, so that no
// single fold decides; the answer is the smallest set whose error is near the least one.
//
// The search makes hundreds of fits, so that only some of many trials and samples are used in it; the set
// that is found is then fitted to all.
#pragma once

#include <set>
#include <utility>
#include <vector>

#include "identify/diagnosis/diagnosis.h"
#include "identify/diagnosis/fit/folds.h"
#include "identify/diagnosis/fit/refit.h"
#include "identify/diagnosis/score/scored_model.h"
#include "identify/diagnosis/select/choice_of_sets.h"
#include "identify/diagnosis/select/misfit_scale.h"

namespace sinew::diagnosis {

class CrossValidatedSearch {
 public:
  using Set = std::vector<int>;

  /// The arguments must outlive the search.
  CrossValidatedSearch(const Problem& problem, const Refitter& refitter,
                       const std::vector<Candidate>& candidates, const MisfitScale& scale,
                       const DiagnosisOptions& options);

  /// True if there are data that can be left out in turn.
  [[nodiscard]] bool possible() const { return folds_.size() > 1; }
  /// The problem with the training data of the search: all trials, or twenty of them, spaced evenly in the
  /// order of their names; of many samples every second, third, ...
  [[nodiscard]] const Problem& searched() const { return searched_; }
  /// What is left out in turn.
  [[nodiscard]] const std::vector<Fold>& folds() const { return folds_; }

  /// Root mean square of the weighted residuals of each fold, left out of the fit; empty if a fit failed.
  /// @param start [P] from which every fit starts
  /// @param tolerance relative, of the cost
  [[nodiscard]] std::vector<double> LeftOutErrors(const Set& released, const Vector& start,
                                                  double tolerance) const;
  /// Their geometric mean; infinite if a fit failed.
  [[nodiscard]] double LeftOutError(const Set& released, const Vector& start) const;

  /// The smallest error of left-out data with a number of causes.
  struct Step {
    Set released;
    double error = 0;
  };
  /// A set with another candidate in place of a cause that predicts left-out data nearly as well.
  struct Substitute {
    int cause = 0;
    int candidate = 0;
    double error = 0;  ///< of left-out data, as a share of that of the answer
    Refit refit;       ///< ordinary least squares
  };
  /// A set that could have been chosen.
  struct Resampled {
    Set released;
    Vector point;  ///< [P] fitted to the searched data
    double share = 0;
  };
  struct Outcome {
    Set released;
    Refit model;               ///< ordinary least squares
    bool misfit_left = false;  ///< MisfitScale::Resembles is false with the chosen causes
    double base_error = 0;     ///< of left-out data by the base model
    double error = 0;          ///< of left-out data by this model
    /// Per cause: error of left-out data with it as a share of that without it.
    std::vector<std::pair<int, double>> left_out_shares;
    std::vector<Step> ladder;  ///< from no cause on, as far as the search went
    std::vector<Step> judged;  ///< every set whose error of left-out data is known
    /// Sets that are chosen in a share > 0 of resamples of the folds (ChosenShares) ...
    std::vector<Resampled> resampled;
    std::vector<std::pair<int, double>> chosen_shares;  ///< ... and each candidate's share
    std::vector<Substitute> substitutes;                ///< best first
  };
  /// Searches for the smallest set that predicts left-out data nearly as well as the best one, starting from
  /// the base model; ends early if what one cause leaves may be noise (MisfitScale::Resembles), and if what a
  /// set leaves is no more than noise that is stated or visible (MisfitScale::IsNoMore). No cause where the
  /// base model cannot be fitted without some part of the data. Errors: those of Problem::Predict;
  /// "interrupted".
  [[nodiscard]] Result<Outcome> Run(const ScoredModel& base);

 private:
  struct Trial {
    Set released;
    Vector point;  ///< [P]
    double fitted_error = 0;
    double left_out_error = 0;
    std::vector<double> fold_errors;
  };
  [[nodiscard]] std::vector<int> Promising(const ScoredModel& scored, const Set& have) const;
  void AddDraws(int candidate, int draws, const Vector& point, std::vector<Vector>& starts) const;
  void Grow(const Trial& from, const ScoredModel& scored, std::vector<Trial>& made);
  void FitAll(std::vector<Trial>& trials, const std::vector<std::vector<Vector>>& starts, double tolerance,
              std::size_t continued) const;
  void Polish(std::vector<Trial>& sets) const;
  void LeaveOut(std::vector<Trial>& sets, double tolerance) const;
  void Shorten(std::vector<Trial>& made) const;
  [[nodiscard]] bool LeavesOnlyNoise(const Trial& one) const;
  void EndWith(std::vector<Trial> made);
  [[nodiscard]] std::vector<Trial> OneLess(const Trial& of) const;
  using Shares = std::vector<std::pair<int, double>>;
  [[nodiscard]] Trial Polished(Trial one) const;
  void Consider(std::vector<Trial> made);
  [[nodiscard]] std::vector<JudgedSet> Judged() const;
  [[nodiscard]] Result<std::vector<Trial>> OneMore(const Trial& of) const;
  [[nodiscard]] Result<Trial> Choose(Shares& shares);
  void Resample(Outcome& outcome) const;
  [[nodiscard]] Result<std::vector<Substitute>> FindSubstitutes(const Trial& of) const;
  [[nodiscard]] Result<Outcome> Conclude();
  [[nodiscard]] double Rows() const;
  [[nodiscard]] bool Interrupted() const {
    return options_.interrupt != nullptr && options_.interrupt->load();
  }

  const Problem& problem_;
  const Refitter& refitter_;
  const std::vector<Candidate>& candidates_;
  const MisfitScale& scale_;
  const DiagnosisOptions& options_;
  EditedView searched_;
  Refitter searched_refitter_;
  std::vector<Fold> folds_;
  int draws_ = 0;  // random starts per set
  std::set<Set> seen_;
  std::vector<Trial> judged_;  // every set whose error of left-out data is known
};

}  // namespace sinew::diagnosis
