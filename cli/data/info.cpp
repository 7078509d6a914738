// sinew data info: what a data set holds.
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "base/numbers.h"
#include "base/text.h"
#include "cli/data/data_commands.h"
#include "cli/terminal.h"
#include "datasets/dataset_hash.h"
#include "datasets/io/dataset_file.h"

namespace sinew {
namespace {

const char* ToWord(Role role) {
  return role == Role::kTrain ? "train" : "validate";
}

struct GridFacts {
  std::size_t samples = 0;
  double first = 0;
  double last = 0;
  double rate = 0;
  std::size_t gaps = 0;
};

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

std::string InfoJson(const Dataset& data) {
  using Json = nlohmann::ordered_json;
  Json json{{"schema", "sinew.dataset/1"}, {"title", data.title},     {"subject", data.subject},
            {"source", data.source},       {"licence", data.licence}, {"synthetic", data.synthetic},
            {"hash", DatasetHash(data)}};
  for (const auto& [name, trial] : data.trials) {
    Json& t = json["trials"][name];
    t = {{"role", ToWord(trial.role)}, {"task", trial.task}, {"conditions", trial.conditions}};
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
  return json.dump(2);
}

std::string InfoText(const std::string& path, const Dataset& data) {
  std::string text = fmt::format("{}: {}{}\n", path, data.title.empty() ? "(no title)" : data.title,
                                 data.synthetic ? " (synthetic)" : "");
  for (const auto& [key, value] : {std::pair{"subject", data.subject}, std::pair{"source", data.source},
                                   std::pair{"licence", data.licence}}) {
    if (!value.empty()) text += fmt::format("  {}: {}\n", key, value);
  }
  for (const auto& [name, constant] : data.constants)
    text += fmt::format("  {} = {} {}\n", name, Readable(constant.value, 4), constant.unit);
  for (const auto& [name, file] : data.files)
    text += fmt::format("  file {} ({} bytes)\n", name, file.size());
  std::vector<std::vector<std::string>> rows{
      {"trial", "role", "grid", "samples", "from [s]", "to [s]", "rate [Hz]", "gaps", "channels"}};
  for (const auto& [name, trial] : data.trials) {
    for (const auto& [grid_name, grid] : trial.grids) {
      const GridFacts facts = FactsOf(grid);
      std::vector<std::string> names;
      for (const auto& [channel, unused] : grid.channels) names.push_back(channel);
      constexpr std::size_t kMaxShown = 4;
      const std::size_t all = names.size();
      if (all > kMaxShown) names.resize(kMaxShown);
      rows.push_back({name, ToWord(trial.role), grid_name, std::to_string(facts.samples),
                      Readable(facts.first, 4), Readable(facts.last, 4), Readable(facts.rate, 4),
                      std::to_string(facts.gaps),
                      Join(names, " ") + (all > kMaxShown ? fmt::format(" ... ({} in all)", all) : "")});
    }
  }
  return text + Table(rows, 2);
}

Result<int> Info(const std::string& path, bool json) {
  SINEW_ASSIGN(const Dataset data, ReadDataset(path));
  std::fputs(json ? (InfoJson(data) + "\n").c_str() : InfoText(path, data).c_str(), stdout);
  return kDone;
}

}  // namespace

void AddInfoCommand(Command data, const RunAction& run) {
  auto path = std::make_shared<std::string>();
  auto json = std::make_shared<bool>(false);
  Command command = data.AddCommand("info", "What a data set holds");
  command.Add("file", *path).Required().Shows("F.h5");
  command.AddFlag("--json", *json, "For machines");
  command.Runs(run, [=] { return Info(*path, *json); });
}

}  // namespace sinew
