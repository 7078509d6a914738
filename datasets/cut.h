// Cutting: a window of a trial becomes a trial of its own, such as a stance out of a recording.
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

/// Drops the force plate channels (PLATE_force_*, PLATE_cop_*, PLATE_moment_*) of all plates but these: a
/// stance belongs to one plate. Errors: the trial has no channel PLATE_force_y; it is then unchanged.
Status KeepPlates(Trial& trial, const std::vector<std::string>& plates);

}  // namespace sinew
