// Import of the files of one trial into a dataset.
#pragma once

#include <string>
#include <vector>

#include "base/error.h"
#include "datasets/dataset.h"
#include "datasets/io/import_options.h"

namespace sinew {

/// Imports the files of one trial, told apart by their extension:
/// - `.trc`: grid `markers`, channels MARKER_x, _y, _z in m, measured;
/// - `.mot`, `.sto`: grid `forces` (force plates), `coordinates` (joint angles, rad and m, inputs), or the
/// file's name;
///   columns keep their names (ChannelName shortens OpenSim 4's paths); those of a plate become
///   PLATE_force_*, PLATE_cop_*, PLATE_moment_*;
/// - `.csv`, `.txt`: the channels that the map names, on a grid of the file's name;
/// - `.mat`, all of them together: the channels that the map names, on one grid or, where their times differ,
/// on one for each clock;
/// - `.osim`: text "model.osim"; `.xml`, `.yaml`, `.yml`, `.obj`: text under the file's name.
///
/// `notes` gets one line for whatever was decided: times that were rebuilt, columns left out, units that no
/// file says. Errors: those of the readers; an unknown extension; a .csv or .mat without map; an entry of the
/// map, or a plate, that no file has; a trial that exists (without `append`), a grid or text that exists with
/// other content; no number in a file. The dataset is then unchanged.
Status ImportFiles(const std::vector<std::string>& paths, const ImportOptions& options, Dataset& dataset,
                   std::vector<std::string>& notes);

/// ImportFiles for one file.
Status ImportFile(const std::string& path, const ImportOptions& options, Dataset& dataset,
                  std::vector<std::string>& notes);

}  // namespace sinew
