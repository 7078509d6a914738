// sinew data info: what a data set holds.
#include <cstdio>

#include "base/numbers.h"
#include "base/text.h"
#include "cli/data/check_text.h"
#include "cli/data/data_commands.h"
#include "cli/data/dataset_json.h"
#include "cli/terminal.h"
#include "datasets/check/mask.h"
#include "datasets/io/dataset_file.h"

namespace sinew {
namespace {

std::string InfoText(const std::string& path, const Dataset& data) {
  std::string info = fmt::format("{}: {}{}\n", path, data.title.empty() ? "(no title)" : data.title,
                                 data.synthetic ? " (synthetic)" : "");
  for (const auto& [key, value] : {std::pair{"subject", data.subject}, std::pair{"source", data.source},
                                   std::pair{"licence", data.licence}}) {
    if (!value.empty()) info += fmt::format("  {}: {}\n", key, value);
  }
  for (const auto& [name, constant] : data.constants)
    info += fmt::format("  {} = {} {}\n", name, Readable(constant.value, 4), constant.unit);
  for (const auto& [name, file] : data.files)
    info += fmt::format("  file {} ({} bytes)\n", name, file.size());
  const auto masked = RecordedMask(data);
  if (masked && !masked->empty())
    info += Wrapped("masked: " + text::MaskText(*masked) + fmt::format(" (files/{})", kMaskFile), 2);
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
      rows.push_back({name, RoleName(trial.role), grid_name, std::to_string(facts.samples),
                      Readable(facts.first, 4), Readable(facts.last, 4), Readable(facts.rate, 4),
                      std::to_string(facts.gaps),
                      Join(names, " ") + (all > kMaxShown ? fmt::format(" ... ({} in all)", all) : "")});
    }
  }
  return info + Table(rows, 2);
}

Result<int> Info(const std::string& path, bool json) {
  SINEW_ASSIGN(const Dataset data, ReadDataset(path));
  SINEW_TRY(Report(
      json ? "-" : "", [&] { return DatasetJson(data); }, InfoText(path, data)));
  return kDone;
}

}  // namespace

void AddInfoCommand(Command data, const RunAction& run) {
  auto path = std::make_shared<std::string>();
  auto json = std::make_shared<bool>(false);
  Command command = data.AddCommand("info", "Show the contents of a data set");
  command.Add("file", *path).Required().Shows("F.h5");
  command.AddFlag("--json", *json, "For machines");
  command.Runs(run, [=] { return Info(*path, *json); });
}

}  // namespace sinew
