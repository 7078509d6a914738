// The folds of cross-validation: parts of the training data that are left out of a fit in turn.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "identify/fit_setup.h"
#include "identify/problem_view.h"

namespace sinew::diagnosis {

/// Part of a trial [s], from `first` to before `last`; the last of a trial has no end.
struct TimeWindow {
  double first = 0;
  double last = 0;
};

struct Fold {
  std::vector<std::string> trials;   ///< increasing; one, if there is a window
  std::optional<TimeWindow> window;  ///< only this part of it; the trajectory goes on through it

  /// The whole trial is left out.
  [[nodiscard]] bool Has(const std::string& trial) const;
  /// Sample i of the block is left out.
  [[nodiscard]] bool LeavesOut(const Block& block, std::size_t i) const;
};

/// With four training trials or more, every trial on its own, or ten groups if there are more than ten;
/// trials are assigned to the groups in turn, so that each group contains all parts of a session. With fewer,
/// each trial is cut into windows of equal duration, six folds or more in all.
[[nodiscard]] std::vector<Fold> FoldsOf(const Problem& problem);

/// Training trials, each once, by name.
[[nodiscard]] std::vector<std::string> TrainingTrials(const Problem& problem);

/// The problem without what a fold leaves out of its training data: whole trials are held out
/// (BlockRole::kValidate), other held-out trials are not compared (kPredicted); of a window the samples are
/// gone.
class FoldView final : public ProblemView {
 public:
  FoldView(const Problem& inner, const Fold& fold);
};

/// The setup without the parameters of trials that the fold leaves out as a whole.
[[nodiscard]] FitSetup WithoutLeftOut(FitSetup setup, const Fold& fold);

/// The setup of a fit to what is left of the trial of a window: its nuisance values without priors get normal
/// priors about those of a fit to all training data, with a hundredth of the information of these. The rest
/// of a stable system's trial does not tell the state in which it began, and a fit would leave it anywhere;
/// where the rest tells it, the priors do not count. Unchanged if the fold leaves out whole trials.
/// @param norms [free] of the Jacobian's columns, all training data, at @param fitted [P]
[[nodiscard]] FitSetup WithTiedNuisance(FitSetup setup, const Fold& fold, const Vector& norms,
                                        const Vector& fitted);

/// Weighted residuals of what the fold leaves out of the training data, at parameters that were fitted to the
/// rest [P]; nuisance values of trials that are left out as a whole are fitted to them.
/// @param record of FitSetup, may be null. Errors: those of Problem::Predict.
[[nodiscard]] Result<Vector> LeftOutResiduals(const Problem& problem, const Fold& fold,
                                              const Vector& parameters, FitRecord* record);

}  // namespace sinew::diagnosis
