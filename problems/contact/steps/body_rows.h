// What the dynamics of the whole body say of the load of one foot, corrected by what they got wrong in other
// steps.
#pragma once

#include <array>
#include <vector>

#include "problems/contact/steps/foot_wrench.h"
#include "problems/contact/steps/step_estimate.h"

namespace sinew {

/// Errors of the whole body's load in stances whose forces are known: of its mass distribution, of its
/// low-pass filter, of the place where the other foot stands. They come back in every step, and are mirrored
/// in those of the other foot.
class BodyLoadErrors {
 public:
  /// @param fitted stances with a body load @param loads [fitted][T] of the foot in each, as the model has
  /// them
  BodyLoadErrors(const std::vector<const Stance*>& fitted,
                 const std::vector<std::vector<ContactLoad>>& loads);

  /// No stance has a load of the whole body, or that differs from the foot's by more than a quarter in the
  /// mean of single support: the model is not of a whole body, or of another one.
  [[nodiscard]] bool usable() const { return usable_; }
  /// Root mean square of the vertical force's errors in single support [N].
  [[nodiscard]] double vertical() const { return vertical_; }

  /// Of a stance that is not among them: the force in single support, and the moment about the other foot, or
  /// about this one in single support, at every loaded instant. Their errors are correlated in time: each row
  /// counts for the share of it that is new.
  [[nodiscard]] std::vector<LoadRow> RowsFor(const Stance& stance) const;
  /// The whole body's load of a stance that has one, without these errors, in the frame of the foot.
  [[nodiscard]] Wrench CorrectedLoad(const Stance& stance, std::size_t instant) const;
  /// Standard deviation of what is left of the errors at one instant of a new step's single support.
  [[nodiscard]] const Wrench& scatter() const { return scatter_; }

 private:
  [[nodiscard]] Wrench MeanError(SupportPhase phase, double share) const;

  std::vector<std::array<WrenchCurve, kSupportPhases>> curves_;  // [fitted]
  std::array<Wrench, kSupportPhases> deviation_;                 // of a row
  Wrench scatter_ = Wrench::Zero();
  bool usable_ = false;
  double vertical_ = 0;
};

}  // namespace sinew
