// A muscle whose excitation is chosen frame by frame.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "models/muscle/elastic_tendon.h"
#include "models/muscle/force_history.h"
#include "problems/nms/excitation/frame.h"
#include "problems/nms/muscle/muscle_force.h"

namespace sinew {

/// Excitations as they reach a muscle at its frames: delayed, and so much later that the filter at the rate
/// of the frames does not depend on it (FilterLead).
struct ActingExcitations {
  std::vector<double> time;     ///< [K + N, s] when they were sent
  std::vector<double> value;    ///< [K + N, 0..1]
  std::size_t frames_from = 0;  ///< K: those before pass the filter before the first frame (CEINMS only)
};
[[nodiscard]] ActingExcitations ActAtFrames(const MuscleModel& model,
                                            const std::array<double, kMuscleSlots>& numbers,
                                            const MuscleSignals& signals);

/// With rigid and elastic tendon: the same force as ComputeMuscleForce has for the excitations that were
/// chosen, sent at the times of `acting`.
class FreeMuscle {
 public:
  /// What it is made of must outlive it. @param trace of the muscle under any excitation
  FreeMuscle(const MuscleCurves& curves, const MuscleModel& model,
             const std::array<double, kMuscleSlots>& numbers, const MuscleSignals& signals,
             const ActingExcitations& acting, const MuscleTrace<double>& trace);
  FreeMuscle(const FreeMuscle&) = delete;
  FreeMuscle& operator=(const FreeMuscle&) = delete;

  /// At the frame after the last one that was chosen. Errors: no equilibrium of fibre and tendon.
  [[nodiscard]] Result<ForceAt> Force(double excitation) const;
  /// Goes on to the next frame. @return the force of this one [N]
  Result<double> Choose(double excitation);

 private:
  using Slope = Dual<1>;  // for the excitation
  [[nodiscard]] Slope Activation(ExcitationFilter<Slope>& filter, const Slope& excitation) const;

  const MuscleCurves& curves_;
  const MuscleModel& model_;
  const MuscleSignals& signals_;
  const MuscleTrace<double>& trace_;
  HillMuscle<Slope> muscle_;
  Slope sine_;
  Slope shape_;
  ExcitationFilter<Slope> filter_;
  bool settles_;  // the first excitation was there before
  ForceHistory<double> history_;
  bool remembers_;
  std::vector<double> length_;  // of the unit at the angles as they were
  std::optional<ElasticFibre<Slope>> fibre_;
  std::size_t frame_ = 0;
};

}  // namespace sinew
