// What a check of data found, for machines: schema sinew.check/1.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "datasets/check/check.h"
#include "datasets/dataset.h"

namespace sinew {

/// Of data before anything of them is masked.
[[nodiscard]] nlohmann::ordered_json CheckJson(const Dataset& data, const CheckReport& report);

}  // namespace sinew
