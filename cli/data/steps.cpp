// sinew data steps: steps that no plate measured become trials, by the motion of the feet.
#include <cmath>

#include "base/text.h"
#include "cli/command_files.h"
#include "cli/data/contact_settings.h"
#include "cli/data/data_commands.h"
#include "cli/data/dataset_json.h"
#include "cli/terminal.h"
#include "cli/work_options.h"
#include "datasets/io/dataset_file.h"
#include "problems/contact/motion/loaded_span.h"
#include "problems/contact/steps/motion_steps.h"

namespace sinew {
namespace {

struct StepsWords {
  std::string path;
  std::string config;
  std::vector<std::string> trials;
  std::string out;
  bool list = false;
  bool drop = false;
  std::string json;
};

std::string Milliseconds(const EventDelay& delay) {
  std::string text = fmt::format("{:.0f} ms", 1e3 * delay.mean);
  if (std::isfinite(delay.scatter)) text += fmt::format(" +-{:.0f} ms", 1e3 * delay.scatter);
  return text;
}

std::string StepsText(const MotionSteps& found) {
  std::string text =
      found.measured > 0
          ? fmt::format("plates of {} steps measure their begin {} and their end {} after the motion's",
                        found.measured, Milliseconds(found.begin), Milliseconds(found.end))
          : std::string(
                "no step on a plate tells how late the motion's begin and end are: taken as they are");
  text = Wrapped(text, 0);
  for (const MotionSteps::OfTrial& of : found.trials) {
    text += Wrapped(fmt::format("trial {}: {} steps without a plate; {} on a plate, {} cut off by the record",
                                of.trial, of.steps.size(), of.measured, of.cut_off),
                    0);
    std::vector<std::vector<std::string>> rows{{"foot", "from [s]", "to [s]", "trial"}};
    for (const MotionStep& step : of.steps)
      rows.push_back(
          {step.plate, fmt::format("{:.3f}", step.from), fmt::format("{:.3f}", step.to), step.trial});
    if (rows.size() > 1) text += Table(rows, 2);
  }
  return text;
}

nlohmann::ordered_json StepsJson(const MotionSteps& found) {
  using Json = nlohmann::ordered_json;
  const auto delay = [&](const EventDelay& of) {
    return Json{{"mean_s", found.measured > 0 ? Json(of.mean) : Json()},
                {"scatter_s", std::isfinite(of.scatter) ? Json(of.scatter) : Json()}};
  };
  Json json{{"schema", "sinew.steps/1"},
            {"measured_steps", found.measured},
            {"begin_delay", delay(found.begin)},
            {"end_delay", delay(found.end)}};
  json["trials"] = Json::array();
  for (const MotionSteps::OfTrial& of : found.trials) {
    Json trial{{"trial", of.trial}, {"on_a_plate", of.measured}, {"cut_off", of.cut_off}};
    trial["steps"] = Json::array();
    for (const MotionStep& step : of.steps)
      trial["steps"].push_back(
          {{"plate", step.plate}, {"from_s", step.from}, {"to_s", step.to}, {"trial", step.trial}});
    json["trials"].push_back(std::move(trial));
  }
  return json;
}

// Those that were named, or all recordings: trials with coordinates that were not cut from others.
std::vector<std::string> Searched(const StepsWords& words, const Dataset& data) {
  if (!words.trials.empty()) return words.trials;
  std::vector<std::string> names;
  for (const auto& [name, trial] : data.trials) {
    if (!WindowOf(trial) && trial.grids.count("coordinates") > 0) names.push_back(name);
  }
  return names;
}

Result<int> Steps(const StepsWords& words) {
  if (words.list && (words.drop || !words.out.empty())) return Fail("--list: nothing is written with it");
  SINEW_ASSIGN(const FileLocks locks, words.list
                                          ? ClaimFiles({{words.path, words.config}, {}, words.json})
                                          : ClaimInPlace(words.path, words.out, {words.config}, words.json));
  SINEW_ASSIGN(Dataset data, ReadDataset(words.path));
  SINEW_ASSIGN(const ContactSettings settings, ContactSettingsOf(words.path, data, words.config));
  const std::vector<std::string> names = Searched(words, data);
  if (names.empty())
    return Fail("{}: no trial holds coordinates and is no step already; run `sinew data kinematics` first",
                words.path);
  const auto found = FindMotionSteps(data, settings, names);
  if (!found) return Fail("{}: {}", words.path, found.error().message);
  std::size_t made = 0;
  for (const MotionSteps::OfTrial& of : found->trials) {
    made += of.steps.size();
    if (words.list) continue;
    const Status cut = CutMotionSteps(of, data);
    if (!cut) return Fail("{}: {}", words.path, cut.error().message);
    if (words.drop && !of.steps.empty()) data.trials.erase(of.trial);
  }
  if (!words.list && made > 0) SINEW_TRY(WriteDataset(words.out.empty() ? words.path : words.out, data));
  SINEW_TRY(Report(
      words.json, [&] { return StepsJson(*found); }, StepsText(*found)));
  if (made > 0) return kDone;
  Print(stderr, fmt::format("sinew: no usable answer: {}: no step without a plate was found\n", words.path));
  return kNotUsable;
}

}  // namespace

void AddStepsCommand(Command data, const RunAction& run) {
  auto words = std::make_shared<StepsWords>();
  Command command = data.AddCommand(
      "steps", "Find the steps that no plate measured and make trials of them (docs/walking.md)");
  command.Add("file", words->path).Required().Shows("F.h5");
  command.Add("--config", words->config, "Settings with key `contact`; default: contact.yaml of the data set")
      .Shows("C.yaml");
  command.Add("--trial", words->trials, "Recordings to search; default: all with coordinates")
      .Split(',')
      .Shows("TRIAL");
  command.AddFlag("--list", words->list, "Only say what is found");
  command.AddFlag("--drop", words->drop, "Remove the recordings that steps were cut from");
  command.Add("--out", words->out, "Data set to write; default: F.h5 itself").NotEmpty().Shows("G.h5");
  AddJsonTo(command, words->json);
  command.Runs(run, [=] { return Steps(*words); });
}

}  // namespace sinew
