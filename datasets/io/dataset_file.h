// The dataset file: HDF5 that h5py and MATLAB read and write too.
#pragma once

#include <string>

#include "base/error.h"
#include "base/hdf5_tree.h"
#include "datasets/dataset.h"

namespace sinew {

/// Reads a file of schema "dataset/1" and converts units to SI.
///
/// Vectors may have shape [N], [N, 1] or [1, N], scalars any shape of one value (MATLAB has no others); a
/// grid's time may have an attr `unit` (ms). Errors, with the path in the file: not HDF5, no or another
/// schema, a group or attribute that is not part of the layout, a channel whose length differs from its time,
/// an unknown unit, a role other than train and validate, a kind other than measured and input, time that
/// does not increase (index and both values), everything that Dataset::Check refuses.
Result<Dataset> ReadDataset(const std::string& path);

/// The same of a file's content, whose numbers are taken over without a copy.
Result<Dataset> DatasetOf(Hdf5Node root);

/// Writes the file in one step; the same dataset gives the same bytes. Errors: those of Dataset::Check; a
/// folder that cannot be written.
Status WriteDataset(const std::string& path, const Dataset& dataset);

}  // namespace sinew
