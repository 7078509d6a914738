// Cutting: a window of a trial becomes a trial of its own, such as a stance out of a recording, or a long
// recording becomes several trials.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "datasets/dataset.h"

namespace sinew {

/// What CutTrial keeps, and under which name.
struct TrialWindow {
  std::string trial;              ///< the source, which is not changed
  double start_s = 0;             ///< first instant that is kept
  double end_s = 0;               ///< last instant that is kept, > start_s
  std::string name;               ///< of the new trial
  std::optional<Role> role = {};  ///< that of the source, if not given
  double margin_s = 0.25;         ///< see CutTrial, >= 0
};

/// Adds the part of a trial within [start_s, end_s] as a new trial, and writes the window to its conditions
/// `window_start_s` and `window_end_s`, the recording's name to `cut_from`.
///
/// The grids `markers`, `coordinates`, and those that hold inputs only keep margin_s more on both sides, so
/// that splines and filters have no end effects inside the window and delayed inputs have their past. Errors:
/// no such trial; the new name is taken; the window is empty, or a grid has no sample in it (the message
/// states the range that there is). The dataset is then unchanged.
Status CutTrial(Dataset& dataset, const TrialWindow& window);

/// Replaces a trial by pieces of it, in their order, named TRIAL_1, TRIAL_2, ... (with leading zeros): as
/// many as fit best into what all its grids cover, the last one half as long to one and a half times as long
/// as the others. No sample belongs to two pieces, but for the margins of CutTrial. One piece only: nothing
/// changes.
/// @param length_s of a piece, > 0 @return the names of the pieces, or of the trial if it is one. Errors: no
/// such trial; its grids cover no common time; more than 10000 pieces; those of CutTrial. The dataset is then
/// unchanged.
Result<std::vector<std::string>> SplitTrial(Dataset& dataset, const std::string& trial, double length_s);

/// Drops the force plate channels (PLATE_force_*, PLATE_cop_*, PLATE_moment_*) of all plates but these: a
/// stance belongs to one plate. Errors: the trial has no channel PLATE_force_y; it is then unchanged.
Status KeepPlates(Trial& trial, const std::vector<std::string>& plates);

}  // namespace sinew
