// Samples of measured channels at the times of a contact problem. Those of a force plate that a block
// compares: as they are, or local fits to them at the frames of the motion.
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

/// The value at every prediction time of the parabola that fits the samples within a quarter of a frame, or
/// within one sample, of it best (LocalPolynomial). A mean over the frame would be flattened where the force
/// bends, and early by half a sample; a single sample has more noise. Where samples within half a frame are
/// not those of a parabola, as where friction turns round between two frames (chi-squared test at 0.001):
/// only those within one sample. Where the samples end: a line or a mean. The centre of pressure is weighted
/// by the vertical force. Left out: frames beside which a sample is missing and, for the centre of pressure,
/// light feet. `sigma` becomes that of the fitted values, `relative_weight` says where it is another one;
/// both are left alone if the channel states none. Sets `later`, too.
/// @param level [unit, > 0] standard deviation of a sample, or what else an error of the value is compared
/// with; infinite: every parabola will do
void AddLocalFits(const Grid& grid, const Channel& channel, const std::string& plate, bool is_cop,
                  double force_share, double level, Block& block);

/// A channel at any time, linear between samples; NaN beside a gap and outside.
[[nodiscard]] double ValueAt(const Grid& grid, const Channel& channel, double time);

}  // namespace sinew
