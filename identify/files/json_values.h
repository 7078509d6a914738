// What the JSON results have in common.
#pragma once

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "identify/files/run_file.h"
#include "identify/text/sentence.h"

namespace sinew::files {

using Json = nlohmann::ordered_json;

/// null if it is not finite: JSON has no NaN and no infinity.
inline Json Finite(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

/// The first fields of a result: what it is, and from which problem and data.
inline Json ResultHead(const std::string& schema, const Provenance& provenance) {
  return {{"schema", schema}, {"problem", provenance.problem}, {"data", provenance.data_file}};
}

/// Kind and subject of each sentence.
inline Json FromSentences(const std::vector<text::Sentence>& sentences) {
  Json json = Json::array();
  for (const text::Sentence& sentence : sentences)
    json.push_back(
        {{"kind", text::ToString(sentence.kind)}, {"about", sentence.about}, {"step", sentence.step}});
  return json;
}

/// The facts of warnings (identify/warning.h).
inline Json FromWarnings(const std::vector<Warning>& warnings) {
  Json json = Json::array();
  for (const Warning& warning : warnings) {
    Json numbers = Json::array();
    for (const double number : warning.numbers) numbers.push_back(Finite(number));
    json.push_back({{"kind", ToString(warning.kind)},
                    {"names", warning.names},
                    {"numbers", numbers},
                    {"message", warning.message},
                    {"step", warning.step}});
  }
  return json;
}

}  // namespace sinew::files
