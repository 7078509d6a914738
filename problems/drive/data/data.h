// From measured trials to runs: which channels, constants and conditions a drive needs.
#pragma once

#include <string>
#include <vector>

#include "datasets/dataset.h"
#include "identify/layout.h"
#include "models/drive/dynamics.h"
#include "models/drive/run.h"
#include "problems/drive/data/conventions.h"
#include "problems/drive/data/starts.h"
#include "problems/drive/effects.h"
#include "problems/drive/settings.h"

namespace sinew {

/// Where a block gets its numbers from.
struct DriveBlock {
  int run = 0;
  int channel = 0;                                  ///< index into kDriveChannels
  std::vector<int> rows;                            ///< [stops of the run] row of the block, or -1
  std::vector<double> position, velocity, command;  ///< [N of the block] signals at its samples
};

struct DriveData {
  DriveTraits traits;
  DriveScales scales;
  DriveStarts starts{};
  DriveJoint joint;
  DriveCommand command;
  std::vector<DriveRun> runs;
  std::vector<DriveMotion> motions;  ///< [runs] as measured, without their runs
  Layout layout;                     ///< without columns
  std::vector<DriveBlock> blocks;    ///< as in the layout
  bool known_noise = false;          ///< weights are 1 / sigma
  DriveConventions conventions;      ///< what contradicts the units and signs of the recording
  std::vector<std::string> notes;
};

/// Finds input, outputs and constants, aligns them, and estimates starts.
/// @param margin [s] the predictions continue so far before the first and after the last sample, as far as
/// the input is known there.
/// Errors: no input or two, an input with a gap, units that are neither rotary nor linear, nothing measured
/// to fit, a channel that does not vary, a reference without controller, no supply voltage.
Result<DriveData> PrepareDriveData(const Dataset& data, const DriveSettings& settings, double margin);

}  // namespace sinew
