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

/// Weighted residuals of what the fold leaves out of the training data, at parameters that were fitted to the
/// rest. Nuisance values of its trials are fitted to these trials, whole ones also where only a window is
/// left out: the rest of a stable system's trial does not tell the state in which it began. Nuisance values
/// with priors are not fitted to a window.
/// @param fitted [P] to all training data: its nuisance values are where these fits start
/// @param record of FitSetup, may be null. Errors: those of Problem::Predict.
[[nodiscard]] Result<Vector> LeftOutResiduals(const Problem& problem, const Fold& fold,
                                              const Vector& parameters, const Vector& fitted,
                                              FitRecord* record);

}  // namespace sinew::diagnosis
