// Samples of measured channels at the times of a contact problem. Those of a force plate that a block
// compares: as they are, or averaged around the frames of the motion.
#pragma once

#include <string>

#include "datasets/dataset.h"
#include "identify/layout.h"

namespace sinew {

/// Measured samples of a channel at the prediction times; gaps and, for the centre of pressure, light feet
/// are left out. Sets sample, measured and sigma. @param force_share of the greatest vertical force, below
/// which a foot is light
void AddSamples(const Grid& grid, const Channel& channel, const std::string& plate, bool is_cop,
                double force_share, Block& block);

/// Means over half a frame on both sides of every prediction time, where all samples in it are there: curves
/// of the motion that are limited to a few Hz cannot follow what a plate resolves in a millisecond. The
/// centre of pressure is weighted by the vertical force. `sigma` is divided by the root of the number of
/// samples. Sets `later`, too.
void AddAverages(const Grid& grid, const Channel& channel, const std::string& plate, bool is_cop,
                 double force_share, Block& block);

/// A channel at any time, linear between samples; NaN beside a gap and outside.
[[nodiscard]] double ValueAt(const Grid& grid, const Channel& channel, double time);

}  // namespace sinew
