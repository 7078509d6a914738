// A data set for machines, and the end of every command that writes one.
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>

#include "base/error.h"
#include "datasets/dataset.h"

namespace sinew {

/// Samples of one grid.
struct GridFacts {
  std::size_t samples = 0;
  double first = 0;      ///< [s]
  double last = 0;       ///< [s]
  double rate = 0;       ///< [Hz]
  std::size_t gaps = 0;  ///< values that were not measured, over all channels
};

[[nodiscard]] GridFacts FactsOf(const Grid& grid);

[[nodiscard]] const char* RoleName(Role role);

/// What `sinew data info --json` prints, schema sinew.dataset/1.
[[nodiscard]] nlohmann::ordered_json DatasetJson(const Dataset& data);

/// Text of JSON; bytes of names that are not UTF-8 are replaced.
[[nodiscard]] std::string ToText(const nlohmann::ordered_json& json);

/// Writes JSON if it was asked for, and prints the text for people unless standard output has the JSON.
/// @param path of --json: empty if it was not given
Status Report(const std::string& path, const std::function<nlohmann::ordered_json()>& json,
              const std::string& text);

}  // namespace sinew
