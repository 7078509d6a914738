// sinew data stances: the stances of a recording become trials.
#include "datasets/stances/stances.h"

#include <cmath>

#include "base/numbers.h"
#include "base/text.h"
#include "cli/command_files.h"
#include "cli/data/data_commands.h"
#include "cli/data/dataset_json.h"
#include "cli/terminal.h"
#include "cli/work_options.h"
#include "datasets/io/dataset_file.h"
#include "datasets/stances/stance_trials.h"

namespace sinew {
namespace {

struct StancesWords {
  std::string path;
  std::vector<std::string> trials;
  std::string out;
  int validate_every = 3;
  bool list = false;
  bool drop = false;
  std::string json;
};

struct FoundStances {
  std::string trial;
  TrialContacts contacts;
  std::vector<StanceTrial> stances;
};

const char* WhyLeftOut(ContactFault fault) {
  switch (fault) {
    case ContactFault::kNone:
      return "";
    case ContactFault::kBegan:
      return "left out: the record begins within it";
    case ContactFault::kEnds:
      return "left out: the record ends within it";
    case ContactFault::kLight:
      return "left out: a light touch";
    case ContactFault::kShort:
      return "left out: short";
    case ContactFault::kLong:
      return "left out: longer than a step";
    case ContactFault::kTwoFeet:
      return "left out: a second foot is on the plate";
    case ContactFault::kGap:
      return "left out: the force has a gap";
  }
  return "";
}

const StanceTrial* TrialOf(const FoundStances& found, const Contact& contact) {
  for (const StanceTrial& stance : found.stances) {
    if (stance.contact.plate == contact.plate && stance.contact.from == contact.from) return &stance;
  }
  return nullptr;
}

std::string StancesText(const FoundStances& found) {
  std::vector<std::vector<std::string>> rows{
      {"plate", "from [s]", "to [s]", "peak [N]", "both feet [s]", "cop x [m]", "trial"}};
  for (const Contact& c : found.contacts.contacts) {
    const StanceTrial* stance = TrialOf(found, c);
    rows.push_back({c.plate, fmt::format("{:.3f}", c.from), fmt::format("{:.3f}", c.to),
                    fmt::format("{:.0f}", c.peak_N), fmt::format("{:.2f}", c.double_support_s),
                    std::isfinite(c.cop_x_m) ? fmt::format("{:.2f}", c.cop_x_m) : "-",
                    stance != nullptr ? fmt::format("{} ({})", stance->name, RoleName(stance->role))
                                      : WhyLeftOut(c.fault)});
  }
  std::string text = fmt::format("trial {}: {} of {} contacts are whole stances\n", found.trial,
                                 found.stances.size(), found.contacts.contacts.size());
  if (rows.size() > 1) text += Table(rows, 2);
  for (const PlateContacts& plate : found.contacts.plates) {
    if (!plate.seen) {
      text +=
          Wrapped(fmt::format("{}: never loaded, or never unloaded: no stance can be found", plate.plate), 2);
      continue;
    }
    text += Wrapped(
        fmt::format("{}: unloaded at {} N, noise {} N; a contact exceeds {} N and ends below {} N{}",
                    plate.plate, Readable(plate.level_N, 2), Readable(plate.noise_N, 2), Readable(plate.on_N),
                    Readable(plate.off_N),
                    plate.places > 1 ? fmt::format("; its stances are at {} places: several plates under one "
                                                   "name",
                                                   plate.places)
                                     : ""),
        2);
  }
  return text;
}

nlohmann::ordered_json StancesJson(const std::vector<FoundStances>& all) {
  using Json = nlohmann::ordered_json;
  Json json{{"schema", "sinew.stances/1"}};
  json["trials"] = Json::array();
  for (const FoundStances& found : all) {
    Json trial{{"trial", found.trial}};
    trial["contacts"] = Json::array();
    for (const Contact& c : found.contacts.contacts) {
      const StanceTrial* stance = TrialOf(found, c);
      trial["contacts"].push_back({{"plate", c.plate},
                                   {"from_s", c.from},
                                   {"to_s", c.to},
                                   {"peak_N", c.peak_N},
                                   {"double_support_s", c.double_support_s},
                                   {"cop_x_m", std::isfinite(c.cop_x_m) ? Json(c.cop_x_m) : Json()},
                                   {"cop_z_m", std::isfinite(c.cop_z_m) ? Json(c.cop_z_m) : Json()},
                                   {"cop_jump_m", c.cop_jump_m},
                                   {"left_out", ToString(c.fault)},
                                   {"trial", stance != nullptr ? stance->name : ""},
                                   {"role", stance != nullptr ? RoleName(stance->role) : ""}});
    }
    trial["plates"] = Json::array();
    for (const PlateContacts& plate : found.contacts.plates) {
      trial["plates"].push_back({{"plate", plate.plate},
                                 {"level_N", plate.level_N},
                                 {"noise_N", plate.noise_N},
                                 {"on_N", plate.on_N},
                                 {"off_N", plate.off_N},
                                 {"places", plate.places},
                                 {"seen", plate.seen}});
    }
    json["trials"].push_back(trial);
  }
  return json;
}

// Trials that are searched: those that were named, or all with plates that are no stances themselves.
Result<std::vector<std::string>> Searched(const StancesWords& words, const Dataset& data) {
  std::vector<std::string> names;
  for (const auto& [name, trial] : data.trials) names.push_back(name);
  for (const std::string& name : words.trials) {
    if (data.trials.count(name) == 0)
      return Fail("{}: trial '{}' does not exist{}", words.path, name, Suggestion(name, names));
  }
  if (!words.trials.empty()) return words.trials;
  names.clear();
  for (const auto& [name, trial] : data.trials) {
    const TrialContacts contacts = FindContacts(trial);
    if (!contacts.plates.empty() && trial.conditions.count("window_start_s") == 0) names.push_back(name);
  }
  if (names.empty())
    return Fail("{}: no trial has a plate (a channel NAME_force_y) that is no stance already", words.path);
  return names;
}

Result<int> Stances(const StancesWords& words) {
  if (words.list && (words.drop || !words.out.empty())) return Fail("--list: nothing is written with it");
  SINEW_ASSIGN(const FileLocks locks, words.list ? ClaimFiles({{words.path}, {}, words.json})
                                                 : ClaimInPlace(words.path, words.out, {}, words.json));
  SINEW_ASSIGN(Dataset data, ReadDataset(words.path));
  SINEW_ASSIGN(const std::vector<std::string> names, Searched(words, data));
  std::vector<FoundStances> all;
  std::string text;
  std::size_t made = 0;
  for (const std::string& name : names) {
    FoundStances found{name, FindContacts(data.trials.at(name)), {}};
    found.stances = PlanStances(name, found.contacts, words.validate_every);
    if (!words.list) {
      const Status cut = CutStances(data, name, found.stances);
      if (!cut) return Fail("{}: {}", words.path, cut.error().message);
      if (words.drop && !found.stances.empty()) data.trials.erase(name);
    }
    made += found.stances.size();
    text += StancesText(found);
    if (!words.list && !words.drop && !found.stances.empty())
      text += Wrapped(
          fmt::format(
              "the recording '{}' is still there: drop it before a fit (sinew data drop, or --drop here)",
              name),
          2);
    all.push_back(std::move(found));
  }
  const std::string& out = words.out.empty() ? words.path : words.out;
  if (!words.list && made > 0) SINEW_TRY(WriteDataset(out, data));
  SINEW_TRY(Report(
      words.json, [&] { return StancesJson(all); }, text));
  if (made == 0) {
    Print(stderr, fmt::format("sinew: no usable answer: {}: no whole stance was found\n", words.path));
    return kNotUsable;
  }
  return kDone;
}

}  // namespace

void AddStancesCommand(Command data, const RunAction& run) {
  auto words = std::make_shared<StancesWords>();
  Command command = data.AddCommand(
      "stances", "Find the stances on all plates and make trials of them (docs/data_check.md)");
  command.Add("file", words->path).Required().Shows("F.h5");
  command.Add("--trial", words->trials, "Recordings to search; default: all with plates")
      .Split(',')
      .Shows("TRIAL");
  command.Add("--validate-every", words->validate_every, "Of so many stances one is held out; 0: none")
      .Between(0, 1000)
      .ShowsDefault();
  command.AddFlag("--list", words->list, "Only say what is found");
  command.AddFlag("--drop", words->drop, "Remove the recordings that stances were cut from");
  command.Add("--out", words->out, "Data set to write; default: F.h5 itself").NotEmpty().Shows("G.h5");
  AddJsonTo(command, words->json);
  command.Runs(run, [=] { return Stances(*words); });
}

}  // namespace sinew
