// What a check of data found, for machines: schema sinew.check/1.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "datasets/check/check.h"
#include "datasets/check/mask.h"
#include "datasets/dataset.h"

namespace sinew {

/// @param masked what was applied; nullptr: nothing was
[[nodiscard]] nlohmann::ordered_json CheckJson(const Dataset& data, const CheckReport& report,
                                               const MaskOutcome* masked);

}  // namespace sinew
