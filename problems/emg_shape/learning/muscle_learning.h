// Estimates for each muscle from the cycles of the training trials, before anything is fitted.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "problems/emg_shape/learning/recorded_trial.h"

namespace sinew {

/// A recording, and the estimates for its muscles from its own cycles; of training trials only.
struct LearntRecording : RecordedTrial {
  struct Muscle {
    BurstPattern bursts;
    std::vector<double> curve;  ///< mean EMG over a cycle; [0] and the end are one
    EmgScatterFactors factors;
    std::vector<double> emg;    ///< CycleScatter::emg, of the finite values of `measured`
    std::vector<double> clean;  ///< the same without noise, as another electrode records it
  };
  std::map<std::string, Muscle> learnt;
};

/// Fills `recordings` and the muscles, which have their names. @return the timing that all muscles have in
/// common in a cycle, standard deviation [cycle]. Errors: those of FitShape, with muscle and trial.
Result<double> LearnMuscles(const EmgShapeSettings& settings, int knots, const EmgReference& reference,
                            std::vector<LearntRecording>& recordings, std::vector<EmgMuscle>& muscles);

}  // namespace sinew
