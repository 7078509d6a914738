// How finely the curve of a muscle's EMG over a cycle has to be drawn.
#pragma once

#include <string>
#include <vector>

#include "problems/emg_shape/learning/recorded_trial.h"

namespace sinew {

constexpr int kUsualKnots = 14;  ///< of ankle movements: docs/decisions/emg_shape_model.md

/// The fewest control points (14, 20 or 28) whose curves predict cycles that were left out nearly as well (2
/// % of the RMSE) as any of these would; of the muscle that needs most. A curve per training trial, one in
/// five cycles left out in turn. Without such cycles: kUsualKnots.
[[nodiscard]] int ChooseKnots(const std::vector<const RecordedTrial*>& recordings,
                              const std::vector<EmgMuscle>& muscles);

}  // namespace sinew
