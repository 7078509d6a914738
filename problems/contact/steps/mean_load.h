// The mean load of the fitted steps over the phase of the stance: what a new step is expected to be near to.
#pragma once

#include <array>
#include <vector>

#include "problems/contact/steps/foot_wrench.h"
#include "problems/contact/steps/step_estimate.h"

namespace sinew {

/// Force and moment about the foot's middle on the floor, in the frame of the foot and mirrored for the other
/// one. A new step differs from the mean by a process of a tenth of a second's memory (Ornstein-Uhlenbeck)
/// whose size is expected beforehand, as of three steps, and learnt from how the fitted ones differ: 2 % of
/// the greatest vertical force forward, 4 % upward and 1.5 % outward, twice what two recordings of walking
/// show, and moments as if the centre of pressure moved by 10 % of the sole's length forward and 6 % outward:
/// a model's feet lie differently in their shoes by so much.
class MeanLoad {
 public:
  /// @param fitted not empty @param loads [fitted][T] of the foot @param floor_height [m]
  MeanLoad(const std::vector<const Stance*>& fitted, const std::vector<std::vector<ContactLoad>>& loads,
           double floor_height);

  [[nodiscard]] Wrench At(double phase) const;
  /// Standard deviation of a new step about the mean.
  [[nodiscard]] const Wrench& scatter() const { return scatter_; }

  /// Of a stance that is not among them, at every loaded instant. @param larger factors of the scatter, >= 1
  [[nodiscard]] std::vector<LoadRow> RowsFor(const Stance& stance, const Wrench& larger) const;

 private:
  std::vector<WrenchCurve> curves_;  // [fitted] over the phase of the stance
  Wrench scatter_ = Wrench::Zero();
  double floor_height_ = 0;
};

}  // namespace sinew
