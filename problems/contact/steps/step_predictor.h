// Steps without their plates: what fitted steps, and the motion of the whole body, tell of their forces.
#pragma once

#include <optional>
#include <vector>

#include "problems/contact/steps/body_rows.h"
#include "problems/contact/steps/mean_load.h"
#include "problems/contact/steps/step_estimate.h"

namespace sinew {

/// What the fitted steps have taught. The problem, its stances and the parameters must outlive it.
class StepPredictor {
 public:
  /// @param fitted not empty @param loads [fitted][T] of the foot in each, as the model has them
  /// @param parameters [P] of the answer
  StepPredictor(const ContactProblem& problem, std::vector<const Stance*> fitted,
                const std::vector<std::vector<ContactLoad>>& loads, const Vector& parameters);

  /// By the mean deviation of the fitted steps, and by what every step obeys: its mean force, and that it
  /// begins and ends with next to nothing: the most probable vertical force and its place, and the friction
  /// to expect (TakeExpectedFriction). Nothing where the model cannot be evaluated.
  [[nodiscard]] std::optional<StepEstimate> ByMotion(const Stance& stance) const;
  /// And by the mean load of the fitted steps, for a step whose trial does not hold the load of the whole
  /// body. The contact has the vertical force and its place; horizontal force and free moment are the mean of
  /// the friction to expect and of the mean load, weighted by their precisions. Of a step that lasts longer
  /// or shorter than the fitted ones, as in another gait, or whose force by its motion alone is farther from
  /// the mean load than the error of that force explains, the mean load is weighted less.
  [[nodiscard]] std::optional<StepEstimate> ByMeanLoad(const Stance& stance) const;
  /// And by the load of the whole body, and the mean load of the fitted steps. The contact has the vertical
  /// force and its place; horizontal force and free moment are what these loads determine alone: friction
  /// depends on slips of millimetres per second, which no recorded motion tells. Where the whole body's load
  /// differs from the mean one by more than both are expected to scatter, as in another gait, the mean
  /// is trusted less by as much. Nothing where the whole body's load is not known.
  [[nodiscard]] std::optional<StepEstimate> ByBody(const Stance& stance) const;

 private:
  [[nodiscard]] std::vector<LoadRow> RowsOfAStep(const Stance& stance) const;
  /// By how much a step differs more from the mean load than is expected, [wrench] >= 1.
  [[nodiscard]] Wrench Unusual(const Stance& stance) const;
  /// The same, by how long it lasts.
  [[nodiscard]] double UnusuallyLong(const Stance& stance) const;
  /// The same, of the forces by the motion alone: the scatter that explains, beside their variance, how far
  /// they are from the mean load (method of moments: DerSimonian, Laird 1986).
  [[nodiscard]] Wrench UnusuallyFar(const Stance& stance, const StepEstimate& by_motion) const;
  /// The parameters [P], the stance's own deviations those that the fitted steps have on average.
  [[nodiscard]] Vector MeanOfPrior(const Stance& stance) const;

  const ContactProblem& problem_;
  std::vector<const Stance*> fitted_;
  const Vector& parameters_;
  BodyLoadErrors errors_;
  MeanLoad mean_;
  double spread_ = 1;
  double mean_force_ = 0;      // [N] of the loaded time
  double mean_duration_ = 0;   // [s]
  double greatest_force_ = 0;  // [N]
};

/// Half width of the 95 % band [T] of a channel of an estimated step. @param block of the channel, whose
/// noise level is what the model does not follow even where it is fitted
[[nodiscard]] Vector HalfWidthOf(const StepEstimate& estimate, std::size_t channel, const Block& block);

}  // namespace sinew
