// sinew data cut, split and drop: stances out of a recording, pieces of a long one.
#include "datasets/cut.h"

#include <optional>

#include "base/numbers.h"
#include "base/text.h"
#include "cli/command_files.h"
#include "cli/data/data_commands.h"
#include "cli/data/dataset_json.h"
#include "cli/work_options.h"
#include "datasets/io/dataset_file.h"

namespace sinew {
namespace {

struct CutWords {
  std::string path;
  std::string trial;
  std::string window;
  std::string as;
  std::string role;
  std::vector<std::string> only;
  std::string json;
};

Result<int> Cut(const CutWords& words) {
  SINEW_ASSIGN(const FileLocks locks, ClaimInPlace(words.path, "", {}, words.json));
  SINEW_ASSIGN(Dataset data, ReadDataset(words.path));
  const auto ends = Split(words.window, ':');
  const auto first = ends.size() == 2 ? ParseNumber(ends[0]) : std::nullopt;
  const auto last = ends.size() == 2 ? ParseNumber(ends[1]) : std::nullopt;
  if (!first || !last) return Fail("--window {}: expected FROM:TO in seconds, such as 0.6:1.3", words.window);
  if (!(*first < *last)) return Fail("--window {}: expected an end after its start", words.window);
  TrialWindow window;
  window.trial = words.trial;
  window.start_s = *first;
  window.end_s = *last;
  window.name = words.as;
  SINEW_ASSIGN(window.role, ParseRole(words.role));
  const Status cut = CutTrial(data, window);
  if (!cut) return Fail("{}: {}", words.path, cut.error().message);
  if (!words.only.empty()) {
    const Status kept = KeepPlates(data.trials[words.as], words.only);
    if (!kept) return Fail("--plate: trial '{}' {}", words.trial, kept.error().message);
  }
  SINEW_TRY(WriteDataset(words.path, data));
  SINEW_TRY(Report(
      words.json, [&] { return DatasetJson(data); },
      fmt::format("{}: trial {} is {} s to {} s of {}\n", words.path, words.as, Readable(*first),
                  Readable(*last), words.trial)));
  return kDone;
}

struct SplitWords {
  std::string path;
  std::optional<double> every;
  std::string trial;
  std::string json;
};

Result<int> SplitTrials(const SplitWords& words) {
  if (!(*words.every > 0)) return Fail("--every {}: expected more than 0 s", *words.every);
  SINEW_ASSIGN(const FileLocks locks, ClaimInPlace(words.path, "", {}, words.json));
  SINEW_ASSIGN(Dataset data, ReadDataset(words.path));
  std::vector<std::string> trials{words.trial};
  if (words.trial.empty()) {
    trials.clear();
    for (const auto& [name, trial] : data.trials) {
      if (trial.role == Role::kTrain) trials.push_back(name);
    }
    if (trials.empty()) return Fail("{}: no trial has the role train", words.path);
  }
  std::string text;
  for (const std::string& trial : trials) {
    const auto pieces = SplitTrial(data, trial, *words.every);
    if (!pieces) return Fail("{}: {}", words.path, pieces.error().message);
    text += pieces->size() == 1 ? fmt::format("{}: trial {} is too short to be split\n", words.path, trial)
                                : fmt::format("{}: trial {} is now {} trials, {} .. {}\n", words.path, trial,
                                              pieces->size(), pieces->front(), pieces->back());
  }
  SINEW_TRY(WriteDataset(words.path, data));
  SINEW_TRY(Report(
      words.json, [&] { return DatasetJson(data); }, text));
  return kDone;
}

Result<int> Drop(const std::string& path, const std::string& trial, const std::string& json) {
  SINEW_ASSIGN(const FileLocks locks, ClaimInPlace(path, "", {}, json));
  SINEW_ASSIGN(Dataset data, ReadDataset(path));
  if (data.trials.erase(trial) == 0) {
    std::vector<std::string> names;
    for (const auto& [name, unused] : data.trials) names.push_back(name);
    return Fail("{}: trial '{}' does not exist{}", path, trial, Suggestion(trial, names));
  }
  SINEW_TRY(WriteDataset(path, data));
  SINEW_TRY(Report(
      json, [&] { return DatasetJson(data); }, ""));
  return kDone;
}

}  // namespace

void AddCutCommand(Command data, const RunAction& run) {
  auto words = std::make_shared<CutWords>();
  Command command = data.AddCommand("cut", "Copy a window of a trial into a new trial");
  command.Add("file", words->path).Required().Shows("F.h5");
  command.Add("--trial", words->trial, "Trial to cut from").Required();
  command.Add("--window", words->window, "In seconds").Required().Shows("FROM:TO");
  command.Add("--as", words->as, "Name of the new trial").Required();
  command.Add("--role", words->role, "train or validate; default: that of the source");
  command.Add("--plate", words->only, "Keep the forces of these plates only").Split(',').Shows("PLATE");
  AddJsonTo(command, words->json);
  command.Runs(run, [=] { return Cut(*words); });
}

void AddSplitCommand(Command data, const RunAction& run) {
  auto words = std::make_shared<SplitWords>();
  Command command = data.AddCommand("split", "Replace long training trials by pieces of a given length");
  command.Add("file", words->path).Required().Shows("F.h5");
  command.Add("--every", words->every, "Length of a piece").Required().Shows("SECONDS");
  command.Add("--trial", words->trial, "This one alone, whatever its role");
  AddJsonTo(command, words->json);
  command.Runs(run, [=] { return SplitTrials(*words); });
}

void AddDropCommand(Command data, const RunAction& run) {
  auto path = std::make_shared<std::string>();
  auto trial = std::make_shared<std::string>();
  auto json = std::make_shared<std::string>();
  Command command = data.AddCommand("drop", "Remove a trial (the recording that stances were cut from)");
  command.Add("file", *path).Required().Shows("F.h5");
  command.Add("--trial", *trial).Required();
  AddJsonTo(command, *json);
  command.Runs(run, [=] { return Drop(*path, *trial, *json); });
}

}  // namespace sinew
