// When what is wrong dwarfs the noise, any noise model swallows it and likelihoods tell little. A set of
// causes is then judged by what it predicts for trials that were left out of its fit (cross-validation, Stone
// 1974), and sets are built from several beginnings at a time, since a cause may show only once another one
// is in. Trials, not conditions, are left out: without the condition that excites an effect no fit can tell
// its size.
//
// Hundreds of fits are made, so that of many trials only some are searched; what is found is then fitted to
// all.
#pragma once

#include <set>
#include <string>
#include <utility>
#include <vector>

#include "identify/diagnosis/diagnosis.h"
#include "identify/diagnosis/fit/refit.h"
#include "identify/diagnosis/fit/trial_folds.h"
#include "identify/diagnosis/score/scored_model.h"
#include "identify/role_view.h"

namespace sinew::diagnosis {

/// True if the residual wanders, in some channel, much farther than its innovations: no instrument does that.
[[nodiscard]] bool MisfitDominatesNoise(const noise::NoiseModel& noise);

class CrossValidatedSearch {
 public:
  using Set = std::vector<int>;

  CrossValidatedSearch(const Problem& problem, const Refitter& refitter,
                       const std::vector<Candidate>& candidates, const DiagnosisOptions& options);

  /// At least two trials to leave out in turn.
  [[nodiscard]] bool possible() const { return folds_.size() > 1; }
  /// Training trials in the search: all, or twenty of them, evenly from the first to the last by name.
  [[nodiscard]] const Problem& searched() const { return searched_; }
  /// What is left out in turn, of these.
  [[nodiscard]] const std::vector<TrialFold>& folds() const { return folds_; }

  /// Root mean square of the weighted residuals of left-out trials; infinite where a fit failed.
  /// @param start [P] from which every fit starts
  [[nodiscard]] double LeftOutError(const Set& released, const Vector& start) const;

  struct Outcome {
    Set released;
    Refit model;                          ///< ordinary least squares
    bool misfit_still_dominates = false;  ///< what is left is gross still
    double base_error = 0;                ///< of left-out trials, by the base model
    double error = 0;                     ///< by this one
    /// Error of left-out trials with each cause as a share of that without it.
    std::vector<std::pair<int, double>> left_out_shares;
  };
  /// Best set, from the base model on; ends early if one cause leaves nothing gross. Errors: the problem's
  /// own.
  [[nodiscard]] Result<Outcome> Run(const ScoredModel& base);

 private:
  [[nodiscard]] std::vector<int> Promising(const ScoredModel& scored, const Set& have) const;
  struct Trial {
    Set released;
    Vector point;  ///< [P]
    double fitted_error = 0;
    double left_out_error = 0;
  };
  void Grow(const Trial& from, const ScoredModel& scored, std::vector<Trial>& made);
  void FitAll(std::vector<Trial>& trials, const std::vector<std::vector<Vector>>& starts) const;
  void Polish(const ScoredModel& base, std::vector<Trial>& sets) const;
  void LeaveOut(std::vector<Trial>& sets) const;
  [[nodiscard]] std::vector<Trial> OneLess(const Trial& of) const;
  [[nodiscard]] Result<Outcome> Conclude(Trial best, double base_error) const;
  [[nodiscard]] double Rows() const;

  const Problem& problem_;
  const Refitter& refitter_;
  const std::vector<Candidate>& candidates_;
  const DiagnosisOptions& options_;
  RoleView searched_;
  std::vector<TrialFold> folds_;
  int restarts_ = 0;  // of every set, from random places
  std::set<Set> seen_;
};

}  // namespace sinew::diagnosis
