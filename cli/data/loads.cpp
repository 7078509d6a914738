// sinew data loads: force plate channels become OpenSim's files of external loads.
#include <algorithm>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "base/replace_file.h"
#include "base/text.h"
#include "cli/command_files.h"
#include "cli/data/contact_settings.h"
#include "cli/data/data_commands.h"
#include "cli/data/dataset_json.h"
#include "cli/terminal.h"
#include "cli/work_options.h"
#include "datasets/ground_loads.h"
#include "datasets/io/dataset_file.h"
#include "datasets/io/force_file.h"

namespace sinew {
namespace {

namespace fs = std::filesystem;

struct LoadsWords {
  std::vector<std::string> files;
  std::vector<std::string> trials;
  std::string recording;
  std::string out;
  std::string setup;
  std::vector<std::string> bodies;
  std::optional<double> rate;
  std::string json;
};

struct NamedDataset {
  std::string path;
  Dataset data;
};

std::string RecordingOf(const std::string& name, const Trial& trial) {
  return trial.cut_from.empty() ? name : trial.cut_from;
}

// Of the trials that were asked for, or all, in the order of the files: those that hold a load, and those of
// the same recording whose plates measured nothing, so that it is said where nothing predicts them either.
Result<std::vector<LoadSource>> Sources(const LoadsWords& words, const std::vector<NamedDataset>& sets) {
  const auto is_wanted = [&](const std::string& name, const Trial& trial) {
    if (!words.recording.empty() && RecordingOf(name, trial) != words.recording) return false;
    return words.trials.empty() ||
           std::find(words.trials.begin(), words.trials.end(), name) != words.trials.end();
  };
  std::vector<LoadSource> sources;
  std::vector<std::string> names;
  for (const NamedDataset& set : sets) {
    for (const auto& [name, trial] : set.data.trials) {
      names.push_back(name);
      if (!is_wanted(name, trial)) continue;
      sources.push_back({sets.size() > 1 ? set.path + ": " + name : name, RecordingOf(name, trial), &trial});
    }
  }
  for (const std::string& trial : words.trials) {
    if (std::find(names.begin(), names.end(), trial) == names.end())
      return Fail("--trial {}: {} no such trial{}", trial,
                  sets.size() > 1 ? "the data sets hold" : sets.front().path + " holds",
                  Suggestion(trial, names));
  }
  const auto loaded = std::find_if(sources.begin(), sources.end(),
                                   [](const LoadSource& source) { return HoldsLoad(*source.trial); });
  if (loaded == sources.end())
    return Fail("{}: no{} trial has values of a vertical force (channel PLATE_force_y)",
                Join(words.files, ", "), words.trials.empty() && words.recording.empty() ? "" : " such");
  const std::string recording = loaded->recording;
  sources.erase(std::remove_if(sources.begin(), sources.end(),
                               [&](const LoadSource& source) {
                                 return !HoldsLoad(*source.trial) && source.recording != recording;
                               }),
                sources.end());
  return sources;
}

// The body that each plate's force acts on: of --bodies, or that of the plate's first region in the contact
// settings that a data set holds.
Result<std::vector<ExternalForce>> ForcesOn(const LoadsWords& words, const std::vector<NamedDataset>& sets,
                                            const GroundLoads& loads) {
  std::map<std::string, std::string> bodies;
  for (const std::string& word : words.bodies) {
    const auto at = word.find('=');
    if (at == std::string::npos || at == 0 || at + 1 == word.size())
      return Fail("--bodies {}: expected PLATE=BODY", word);
    const std::string plate = word.substr(0, at);
    const auto is_plate = [&](const PlateLoad& load) { return load.plate == plate; };
    if (std::none_of(loads.plates.begin(), loads.plates.end(), is_plate)) {
      std::vector<std::string> names;
      for (const PlateLoad& load : loads.plates) names.push_back(load.plate);
      return Fail("--bodies {}: no trial has a plate '{}'{}", word, plate, Suggestion(plate, names));
    }
    if (!bodies.emplace(plate, word.substr(at + 1)).second)
      return Fail("--bodies: the plate '{}' appears twice", plate);
  }
  for (const NamedDataset& set : sets) {
    if (!words.bodies.empty() || set.data.files.count(kContactSettingsFile) == 0) continue;
    SINEW_ASSIGN(const ContactSettings settings, ContactSettingsOf(set.path, set.data, ""));
    for (const ContactRegionSettings& region : settings.regions) bodies.emplace(region.plate, region.body);
  }
  std::vector<ExternalForce> forces;
  for (const PlateLoad& load : loads.plates) {
    const auto body = bodies.find(load.plate);
    if (body == bodies.end())
      return Fail("--setup: on which body plate '{}' acts is not known: give it as --bodies {}=BODY",
                  load.plate, load.plate);
    forces.push_back(ForceOn(load.plate, body->second));
  }
  return forces;
}

std::string LoadsText(const LoadsWords& words, const GroundLoads& loads) {
  std::string text =
      loads.time.size() < 2
          ? fmt::format("{}: one instant, {:.3f} s; no load but in\n", words.out, loads.time.front())
          : Wrapped(fmt::format("{}: {} instants at {:.5g} Hz, {:.3f} to {:.3f} s; no load but in", words.out,
                                loads.time.size(), 1 / (loads.time[1] - loads.time[0]), loads.time.front(),
                                loads.time.back()),
                    0);
  std::vector<std::vector<std::string>> rows{{"plate", "from [s]", "to [s]", "of trial"}};
  for (const LoadSpan& span : loads.spans)
    rows.push_back(
        {span.plate, fmt::format("{:.3f}", span.from), fmt::format("{:.3f}", span.to), span.source});
  text += Table(rows, 2);
  if (!words.setup.empty()) text += words.setup + "\n";
  return text;
}

nlohmann::ordered_json SpansJson(const std::vector<LoadSpan>& spans) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const LoadSpan& span : spans)
    json.push_back({{"plate", span.plate}, {"from_s", span.from}, {"to_s", span.to}, {"trial", span.source}});
  return json;
}

void PrintGaps(const std::vector<LoadSpan>& gaps) {
  for (const LoadSpan& gap : gaps) {
    Print(stderr,
          Wrapped(fmt::format("note: plate '{}', {:.3f} to {:.3f} s: trial '{}' does not know the force, "
                              "and no other trial does: written as zero",
                              gap.plate, gap.from, gap.to, gap.source),
                  0));
  }
}

nlohmann::ordered_json LoadsJson(const LoadsWords& words, const GroundLoads& loads) {
  using Json = nlohmann::ordered_json;
  Json json{{"schema", "sinew.loads/1"},
            {"out", words.out},
            {"setup", words.setup.empty() ? Json() : Json(words.setup)},
            {"instants", loads.time.size()},
            {"from_s", loads.time.front()},
            {"to_s", loads.time.back()},
            {"spans", SpansJson(loads.spans)},
            {"gaps", SpansJson(loads.gaps)}};
  return json;
}

// The table's name from the folder of the setup, where OpenSim looks for it.
std::string TableName(const LoadsWords& words) {
  std::error_code failed;
  const fs::path folder = fs::absolute(words.setup, failed).parent_path();
  const fs::path table = fs::absolute(words.out, failed).lexically_proximate(folder);
  return table.empty() ? words.out : table.generic_string();
}

Result<int> Loads(const LoadsWords& words) {
  if (words.setup.empty() && !words.bodies.empty()) return Fail("--bodies: only --setup names bodies");
  CommandFiles files{words.files, {words.out}, words.json};
  if (!words.setup.empty()) files.written.push_back(words.setup);
  SINEW_ASSIGN(const FileLocks locks, ClaimFiles(files));
  std::vector<NamedDataset> sets;
  for (const std::string& path : words.files) {
    SINEW_ASSIGN(Dataset data, ReadDataset(path));
    sets.push_back({path, std::move(data)});
  }
  SINEW_ASSIGN(const std::vector<LoadSource> sources, Sources(words, sets));
  SINEW_ASSIGN(const GroundLoads loads, JoinGroundLoads(sources, words.rate.value_or(0)));
  if (!words.setup.empty()) {
    SINEW_ASSIGN(const std::vector<ExternalForce> forces, ForcesOn(words, sets, loads));
    SINEW_TRY(WriteStorage(words.out, ForceTable(loads)));
    SINEW_TRY(ReplaceFile(words.setup, ExternalLoadsText(forces, TableName(words))));
  } else {
    SINEW_TRY(WriteStorage(words.out, ForceTable(loads)));
  }
  PrintGaps(loads.gaps);
  SINEW_TRY(Report(
      words.json, [&] { return LoadsJson(words, loads); }, LoadsText(words, loads)));
  return kDone;
}

}  // namespace

void AddLoadsCommand(Command data, const RunAction& run) {
  auto words = std::make_shared<LoadsWords>();
  Command command = data.AddCommand(
      "loads", "Write measured and simulated ground reactions as OpenSim's external loads (docs/walking.md)");
  command.Add("files", words->files, "Data sets; where two hold a load, the first counts")
      .Required()
      .Shows("F.h5");
  command.Add("--out", words->out, "Table of forces, centres of pressure and moments")
      .Required()
      .NotEmpty()
      .Shows("GRF.mot");
  command.Add("--trial", words->trials, "Trials to join; default: all with values of a plate")
      .Split(',')
      .Shows("TRIAL");
  command
      .Add("--recording", words->recording,
           "Only it and the trials that were cut from it; needed where there are several")
      .NotEmpty()
      .Shows("TRIAL");
  command.Add("--setup", words->setup, "Also an ExternalLoads document").NotEmpty().Shows("X.xml");
  command
      .Add("--bodies", words->bodies,
           "Bodies that the forces act on; default: those of contact.yaml in a data set")
      .Split(',')
      .Shows("PLATE=BODY");
  command.Add("--rate", words->rate, "Of the table in Hz; default: the greatest of the trials").AtLeastZero();
  AddJsonTo(command, words->json);
  command.Runs(run, [=] { return Loads(*words); });
}

}  // namespace sinew
