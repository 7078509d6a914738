// Fits of sets of causes and their errors on left-out data, for the search by cross-validation: many fits, so
// that only some of many trials and samples are used.
#pragma once

#include <atomic>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "identify/diagnosis/diagnosis.h"
#include "identify/diagnosis/fit/folds.h"
#include "identify/diagnosis/fit/refit.h"
#include "identify/diagnosis/score/scored_model.h"
#include "identify/diagnosis/select/candidate_sets.h"
#include "identify/problem_view.h"

namespace sinew::diagnosis {

/// A set of released candidates with what is known of it.
struct FittedSet {
  FittedSet() = default;
  /// Not fitted yet. @param causes increasing
  explicit FittedSet(std::vector<int> causes) : released(std::move(causes)) {}

  std::vector<int> released;  ///< increasing
  Vector point;               ///< [P]
  double fitted_error = 0;    ///< root mean square of the weighted residuals; infinite if the fit failed
  double left_out_error = 0;  ///< geometric mean of ...
  std::vector<double> fold_errors;  ///< ... these, see SetFitter::LeaveOut
  std::vector<Vector> fold_points;  ///< [folds] of [P], fitted without each fold; empty before LeaveOut
};

/// By the error of left-out data; sets of the same error, as of an effect that changes nothing, by size.
[[nodiscard]] bool PredictsBetter(const FittedSet& a, const FittedSet& b);
[[nodiscard]] bool FitsBetter(const FittedSet& a, const FittedSet& b);

class SetFitter {
 public:
  static constexpr double kTolerance = 1e-5;       ///< relative, of the cost, while searching
  static constexpr double kRoughTolerance = 1e-2;  ///< before the sets of one size are shortened
  static constexpr std::size_t kContinued = 3;     ///< short searches that are continued to convergence

  /// The arguments must outlive it.
  SetFitter(const Problem& problem, const Refitter& refitter, const std::vector<Candidate>& candidates,
            const DiagnosisOptions& options, ScoredCandidates scored = ScoredCandidates::kTested);
  SetFitter(const SetFitter&) = delete;
  SetFitter& operator=(const SetFitter&) = delete;

  /// The problem with the training data of the search: all trials, or twenty of them, spaced evenly in the
  /// order of their names; of many samples every second, third, ...
  [[nodiscard]] const Problem& searched() const { return searched_; }
  /// What is left out in turn.
  [[nodiscard]] const std::vector<Fold>& folds() const { return folds_; }
  /// Random starts per set: fewer with many trials, where fits take longer and local minima are fewer.
  [[nodiscard]] int draws() const { return draws_; }
  [[nodiscard]] FitSetup SetupWith(const std::vector<int>& released) const;
  [[nodiscard]] const FitSetup& base() const { return refitter_.base(); }

  /// Fits every set to the searched data. @param starts [sets] points [P], not empty
  /// @param continued see ManyStarts
  void Fit(std::vector<FittedSet>& sets, const std::vector<std::vector<Vector>>& starts, double tolerance,
           std::size_t continued) const;
  /// Fits sets with an effect of more than twelve probe values again by solvers::AlternatingFit, from where
  /// they are and from the best probe values (solvers::ProbedStart): a ripple's period that fits best without
  /// the other causes is often not the one beside them. A set that this does not lower by a hundredth of its
  /// cost stays as it is; of the others the errors of left-out data become unknown. @pre the sets are fitted
  void FitFromProbes(std::vector<FittedSet>& sets) const;
  /// Fills the errors of left-out data, of sets that are fitted: the root mean square of the weighted
  /// residuals of each fold, left out of a fit that starts at the set's point, or where it ended before (none
  /// if a fit failed), and their geometric mean (infinite if a fit failed, or after an interruption).
  void LeaveOut(std::vector<FittedSet>& sets) const;
  /// The same by fits of a few steps, to tell which sets are worth more.
  void LeaveOutRoughly(std::vector<FittedSet>& sets) const;

  /// Norm of the weighted residuals of the searched data. @pre the set is fitted
  [[nodiscard]] double Residual(const FittedSet& one) const { return one.fitted_error * std::sqrt(Rows()); }

  /// The sets with one member of `of` less, fitted and left out. @param known sets that were fitted before:
  /// their points are starts, too @param most_fitted sets that fit worse are not left out: their error of
  /// left-out data is infinite
  [[nodiscard]] std::vector<FittedSet> OneLess(
      const FittedSet& of, const std::vector<FittedSet>& known,
      double most_fitted = std::numeric_limits<double>::infinity()) const;
  /// The same, with one more start each: the member's values go to their null in steps while the others are
  /// fitted, so that these can take over what they are able to (continuation: Nocedal, Wright 2006, section
  /// 11.3).
  [[nodiscard]] std::vector<FittedSet> OneLessByContinuation(const FittedSet& of) const;

  /// The set without the members that change nothing where it is fitted, as an effect at its null (less than
  /// 1e-4 of the fitted error): the same model, at the same point but for their values. The same set if there
  /// are none. @pre the set is fitted
  [[nodiscard]] FittedSet WithoutIdle(const FittedSet& of) const;

  /// Scores beside a fitted set, on the searched data; nothing if the fit failed. Errors: those of
  /// Problem::Predict.
  [[nodiscard]] Result<std::optional<ScoredModel>> Score(const FittedSet& one) const;
  /// The same of several sets, in their order.
  [[nodiscard]] Result<std::vector<std::optional<ScoredModel>>> Score(
      const std::vector<FittedSet>& sets) const;
  /// The sets that do to the searched data what this one does (FindImitatingSets), with starts. Errors: those
  /// of Problem::Predict.
  [[nodiscard]] Result<std::map<std::vector<int>, std::vector<Vector>>> ImitatingSets(
      const FittedSet& of) const;
  /// Known effects that all trials share, not in `have`, the best ten by the linear prediction.
  [[nodiscard]] std::vector<int> Promising(const ScoredModel& scored, const std::vector<int>& have) const;
  /// Unknown terms that a fit can release, not in `have`, the best four.
  [[nodiscard]] std::vector<int> PromisingTerms(const ScoredModel& scored,
                                                const std::vector<int>& have) const;
  /// Starts at `point` with the candidate's parameters anywhere.
  void AddDraws(int candidate, int draws, const Vector& point, std::vector<Vector>& starts) const;

  [[nodiscard]] bool Interrupted() const {
    return options_.interrupt != nullptr && options_.interrupt->load();
  }

 private:
  void ForEachPart(std::size_t sets, const std::function<std::size_t(std::size_t)>& parts,
                   const std::function<void(std::size_t, std::size_t)>& work) const;
  struct LeftOut {
    std::optional<double> error;  ///< nothing if the fold has no samples
    Vector point;                 ///< [P] of the fit without it
  };
  struct Effort {
    double tolerance = 0;  ///< relative, of the cost
    long evaluations = 0;  ///< at most
  };
  [[nodiscard]] Result<LeftOut> LeaveOutFold(const FitSetup& all, const Vector& norms, const Fold& fold,
                                             const Vector* before, const Effort& effort) const;
  void LeaveOutWith(const Effort& effort, std::vector<FittedSet>& sets) const;
  [[nodiscard]] double Rows() const;
  [[nodiscard]] Vector ColumnNorms(const FitSetup& setup) const;
  [[nodiscard]] FittedSet WithoutMember(const FittedSet& of, int c, std::vector<Vector>& starts) const;
  [[nodiscard]] Vector Continued(const FittedSet& of, int c) const;

  const Refitter& refitter_;
  const std::vector<Candidate>& candidates_;
  const DiagnosisOptions& options_;
  EditedView searched_;
  Refitter searched_refitter_;
  std::vector<Fold> folds_;
  ScoredCandidates scored_;
  int draws_ = 0;
};

}  // namespace sinew::diagnosis
