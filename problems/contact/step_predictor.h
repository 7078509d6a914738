// Steps without their plates: what fitted steps, and the motion of the whole body, tell of their forces.
#pragma once

#include <optional>
#include <vector>

#include "problems/contact/body_rows.h"
#include "problems/contact/step_estimate.h"

namespace sinew {

/// What the fitted steps have taught. The problem, its stances and the parameters must outlive it.
class StepPredictor {
 public:
  /// @param fitted not empty @param parameters [P] of the answer @param errors of the whole body's load in
  /// the fitted steps; nothing: not known
  StepPredictor(const ContactProblem& problem, std::vector<const Stance*> fitted, const Vector& parameters,
                std::optional<BodyLoadErrors> errors);

  /// By the mean deviation of the fitted steps, and by what every step obeys: its mean force, and that it
  /// begins and ends with next to nothing. Nothing where the model cannot be evaluated.
  [[nodiscard]] std::optional<StepEstimate> ByMotion(const Stance& stance) const;
  /// And by the load of the whole body. Nothing where that is not known.
  [[nodiscard]] std::optional<StepEstimate> ByBody(const Stance& stance) const;

 private:
  [[nodiscard]] std::vector<LoadRow> RowsOfAStep(const Stance& stance) const;
  [[nodiscard]] std::optional<StepEstimate> Estimate(const Stance& stance,
                                                     const std::vector<LoadRow>& rows) const;

  const ContactProblem& problem_;
  std::vector<const Stance*> fitted_;
  const Vector& parameters_;
  std::optional<BodyLoadErrors> errors_;
  double spread_ = 1;
  double mean_force_ = 0;      // [N] of the loaded time
  double greatest_force_ = 0;  // [N]
};

/// Half width of the 95 % band [T] of a channel of an estimated step. @param block of the channel, whose
/// noise level is what the model does not follow even where it is fitted
[[nodiscard]] Vector HalfWidthOf(const StepEstimate& estimate, std::size_t channel, const Block& block);

}  // namespace sinew
