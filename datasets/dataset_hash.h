// A hash of the content of a dataset, which identifies the data of a result.
#pragma once

#include <string>

#include "datasets/dataset.h"

namespace sinew {

/// 16 hexadecimal digits that depend on everything in the dataset and on nothing else: not on the file's
/// name, its compression or the order of writing. All NaN are equal. 64-bit FNV-1a (Fowler, Noll, Vo 1991).
[[nodiscard]] std::string DatasetHash(const Dataset& dataset);

}  // namespace sinew
