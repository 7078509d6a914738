// A muscle for tests.
#pragma once

#include "models/muscle/hill_muscle.h"

namespace sinew {

inline const MuscleCurves& Curves() {
  static const MuscleCurves curves = MuscleCurves::Default();
  return curves;
}

inline HillMuscle<double> Soleus() {
  HillMuscle<double> muscle;
  muscle.optimal_length = 0.05;
  muscle.tendon_slack_length = 0.25;
  muscle.isometric_force = 3549;
  muscle.pennation = 0.436;
  return muscle;
}

}  // namespace sinew
