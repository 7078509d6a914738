// sinew data check: what is wrong with measured data, before anything is fitted to them.
#include "datasets/check/check.h"

#include <cstdio>

#include "base/text.h"
#include "cli/binding.h"
#include "cli/command_files.h"
#include "cli/data/check_json.h"
#include "cli/data/check_text.h"
#include "cli/data/data_commands.h"
#include "cli/data/data_warnings.h"
#include "cli/data/dataset_json.h"
#include "cli/run_command_line.h"
#include "cli/terminal.h"
#include "cli/work_options.h"
#include "datasets/check/mask.h"
#include "datasets/io/dataset_file.h"

namespace sinew {
namespace {

struct CheckWords {
  std::string path;
  std::string problem;
  std::string config;
  std::string mask;
  std::string out;
  std::string json;
  const Program* program = nullptr;
};

// What a problem makes of the data.
struct ProblemData {
  Layout layout;
  std::vector<std::string> notes;
};

// @param notes of the problem
std::string CheckText(const CheckWords& words, const Dataset& data, const CheckReport& report,
                      const std::vector<std::string>& notes) {
  std::string found =
      report.findings.size() == 1 ? "1 finding" : fmt::format("{} findings", report.findings.size());
  if (report.findings.empty()) found = notes.empty() ? "nothing found" : "no finding";
  if (!notes.empty())
    found += fmt::format(", {} note{} of {}", notes.size(), notes.size() == 1 ? "" : "s", words.problem);
  std::string text = fmt::format("check of {}: {} trials, {} channels: {}\n", words.path, report.trials,
                                 report.channels, found);
  for (const Finding& finding : report.findings) {
    text += Wrapped(text::FindingText(finding), 2);
    const std::string mask = text::MaskText(SuggestMask(data, finding));
    text += Wrapped(text::AdviceText(finding) + (mask.empty() ? "" : " Suggested mask: " + mask + "."), 4);
  }
  for (const std::string& note : notes) text += Wrapped("note: " + note, 2);
  return text;
}

std::string MaskedText(const std::string& out, const std::vector<MaskedSpan>& mask,
                       const MaskOutcome& outcome) {
  std::string text = Wrapped(
      fmt::format("{}: masked are {} ({} values are gaps now)", out, text::MaskText(mask), outcome.values),
      2);
  if (!outcome.removed.empty())
    text += Wrapped("nothing measured is left of " + Join(outcome.removed, ", ") + ": removed", 2);
  return text;
}

// Or the reason why it cannot use the data. Errors: no such problem, no settings.
Result<Result<ProblemData>> ProblemDataOf(const CheckWords& words, const Dataset& data) {
  SINEW_ASSIGN(const ProblemEntry* entry, FindProblem(words.program->problems, words.problem));
  const bool has_settings =
      !words.config.empty() || data.files.count(words.problem + ".yaml") != 0 || entry->settings_optional;
  if (!has_settings)
    return Fail("{}: holds no settings '{}.yaml'; give --config, or leave the problem out", words.path,
                words.problem);
  BindingOptions options;
  options.problem = words.problem;
  options.data = words.path;
  options.config = words.config;
  options.program = words.program;
  const auto binding = Bind(options, false);
  if (!binding) return Result<ProblemData>(tl::unexpected(binding.error()));
  return Result<ProblemData>(ProblemData{binding->problem().layout(), binding->bound.notes});
}

Result<int> Check(const CheckWords& words) {
  if (!words.mask.empty() && words.mask != "auto") return Fail("--mask {}: expected auto", words.mask);
  if (words.mask.empty() && !words.out.empty()) return Fail("--out: nothing is written without --mask auto");
  SINEW_ASSIGN(const FileLocks locks, words.mask.empty()
                                          ? ClaimFiles({{words.path, words.config}, {}, words.json})
                                          : ClaimInPlace(words.path, words.out, {words.config}, words.json));
  SINEW_ASSIGN(Dataset data, ReadDataset(words.path));
  std::string cannot_bind;
  std::vector<std::string> compared;
  std::vector<std::string> notes;
  CheckReport report = CheckData(data);
  if (!words.problem.empty()) {
    SINEW_ASSIGN(const auto of_problem, ProblemDataOf(words, data));
    if (of_problem) {
      report.findings = FindingsOf(data, of_problem->layout, report.findings);
      compared = ComparedChannels(of_problem->layout);
      notes = of_problem->notes;
    } else {
      cannot_bind = of_problem.error().message;
    }
  }
  const std::vector<MaskedSpan> mask = SuggestMask(data, report.findings);
  std::string text = CheckText(words, data, report, notes);
  // What is said about the data as they are is made first: they are masked in place, not in a copy.
  nlohmann::ordered_json json;
  if (!words.json.empty()) json = CheckJson(data, report);
  if (!words.json.empty() && !words.problem.empty()) json["notes"] = notes;
  const auto applied = ApplyMask(data, mask);
  if (words.mask == "auto" && applied && !mask.empty()) {
    const std::string& out = words.out.empty() ? words.path : words.out;
    SINEW_TRY(WriteDataset(out, data));
    text += MaskedText(out, mask, *applied);
    json["masked"] = {{"values", applied->values}, {"removed_trials", applied->removed}};
  }
  SINEW_TRY(Report(
      words.json, [&] { return json; }, text));
  std::string why = cannot_bind;
  if (why.empty() && !applied) why = applied.error().message;
  if (why.empty() && !HasTrainingData(data, compared))
    why = fmt::format("no training trial has anything measured left of {}", Join(compared, ", "));
  if (why.empty()) return kDone;
  Print(stderr, Wrapped("sinew: no usable data: " + why +
                            (report.findings.empty()
                                 ? ""
                                 : "; correct on import what is said above, give another trial the "
                                   "role train, or record again"),
                        0));
  return kNotUsable;
}

}  // namespace

void AddCheckCommand(Command data, const RunAction& run) {
  auto words = std::make_shared<CheckWords>();
  words->program = &data.program();
  Command command =
      data.AddCommand("check", "What is wrong with the data, before anything is fitted (docs/data_check.md)");
  command.Add("file", words->path).Required().Shows("F.h5");
  command.Add("problem", words->problem, "Only what this problem uses").Shows("PROBLEM");
  command.Add("--config", words->config, "Settings of the problem; default: PROBLEM.yaml inside the data set")
      .Shows("C.yaml");
  command.Add("--mask", words->mask, "auto: replace what is wrong by gaps, and record it in the data set")
      .Shows("auto");
  command.Add("--out", words->out, "Data set to write; default: F.h5 itself").NotEmpty().Shows("G.h5");
  AddJsonTo(command, words->json);
  command.Runs(run, [=] { return Check(*words); });
}

}  // namespace sinew
