// What the JSON results have in common.
#pragma once

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "identify/files/run_file.h"

namespace sinew {

using Json = nlohmann::ordered_json;

/// null if it is not finite: JSON knows no NaN and no infinity.
inline Json Finite(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

/// The first fields of a result: what it is, and from which problem and data.
inline Json ResultHead(const std::string& schema, const Provenance& provenance) {
  return {{"schema", schema}, {"problem", provenance.problem}, {"data", provenance.data_file}};
}

}  // namespace sinew
