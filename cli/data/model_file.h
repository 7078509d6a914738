// The OpenSim model that a command of `sinew data` works with.
#pragma once

#include <string>

#include "base/error.h"
#include "datasets/dataset.h"

namespace sinew {

struct ModelFile {
  std::string text;
  std::string name;  ///< for messages
};

/// The file of --model, which becomes the data set's model.osim, or the one that the data set holds.
/// @param model empty: --model was not given @param path of the data set. Errors: neither; not readable.
Result<ModelFile> OpenModel(const std::string& model, const std::string& path, Dataset& data);

}  // namespace sinew
