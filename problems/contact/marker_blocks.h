// Markers on a foot as measured channels: with motion errors the foot's own markers say how it moved, besides
// the forces.
#pragma once

#include <array>
#include <vector>

#include "identify/layout.h"
#include "identify/parameter.h"
#include "identify/problem.h"
#include "problems/contact/stance.h"

namespace sinew {

/// The level to which a marker on a foot follows it: skin and shoe move [m].
constexpr double kMarkerAccuracy = 0.005;

/// Appends a block per marker and axis (NAME_x, NAME_y, NAME_z) to the layout, and notes their indices in the
/// stance. @param columns of the deviations, increasing @param role of the trial's compared blocks
/// @param accuracy [m]
void AddMarkerBlocks(Stance& stance, const std::vector<int>& columns, BlockRole role, double accuracy,
                     Layout& layout);

/// Nuisance parameters of the markers' places on the foot, three per marker in the frame of its body.
[[nodiscard]] std::vector<Parameter> DeclareMarkerOffsets(const Stance& stance, const std::string& name);

/// Predicts the wanted marker blocks of one instant. @param deviation of that instant
void PredictMarkers(const Stance& stance, int instant, const PoseDeviation& deviation, const Query& query,
                    Prediction& prediction);

}  // namespace sinew
