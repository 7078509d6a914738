#include "cli/data/dataset_json.h"

#include <cmath>
#include <cstdio>

#include "cli/terminal.h"
#include "datasets/dataset_hash.h"

namespace sinew {

GridFacts FactsOf(const Grid& grid) {
  GridFacts facts;
  facts.samples = grid.time.size();
  if (!grid.time.empty()) {
    facts.first = grid.time.front();
    facts.last = grid.time.back();
    if (facts.samples > 1) facts.rate = static_cast<double>(facts.samples - 1) / (facts.last - facts.first);
  }
  for (const auto& [name, channel] : grid.channels) {
    for (const double value : channel.values) facts.gaps += std::isfinite(value) ? 0 : 1;
  }
  return facts;
}

const char* RoleName(Role role) {
  return role == Role::kTrain ? "train" : "validate";
}

nlohmann::ordered_json DatasetJson(const Dataset& data) {
  using Json = nlohmann::ordered_json;
  Json json{{"schema", "sinew.dataset/1"}, {"title", data.title},     {"subject", data.subject},
            {"source", data.source},       {"licence", data.licence}, {"synthetic", data.synthetic},
            {"hash", DatasetHash(data)}};
  for (const auto& [name, trial] : data.trials) {
    Json& t = json["trials"][name];
    t = {{"role", RoleName(trial.role)}, {"task", trial.task}, {"conditions", trial.conditions}};
    if (!trial.cut_from.empty()) t["cut_from"] = trial.cut_from;
    for (const auto& [grid_name, grid] : trial.grids) {
      const GridFacts facts = FactsOf(grid);
      Json& g = t["grids"][grid_name];
      g = {{"samples", facts.samples},
           {"first_s", facts.first},
           {"last_s", facts.last},
           {"rate_hz", facts.rate},
           {"gaps", facts.gaps}};
      for (const auto& [channel_name, channel] : grid.channels) {
        g["channels"][channel_name] = {{"unit", channel.unit},
                                       {"kind", channel.kind == ChannelKind::kInput ? "input" : "measured"}};
      }
    }
  }
  for (const auto& [name, constant] : data.constants)
    json["constants"][name] = {{"value", constant.value}, {"unit", constant.unit}};
  json["files"] = Json::array();
  for (const auto& [name, text] : data.files) json["files"].push_back(name);
  return json;
}

std::string ToText(const nlohmann::ordered_json& json) {
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

Status Report(const std::string& path, const std::function<nlohmann::ordered_json()>& json,
              const std::string& text) {
  if (path != "-") Print(stdout, text);
  return path.empty() ? Status() : WriteText(path, ToText(json()));
}

}  // namespace sinew
