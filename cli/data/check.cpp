// sinew data check: what is wrong with measured data, before anything is fitted to them.
#include "datasets/check/check.h"

#include <algorithm>

#include "base/text.h"
#include "cli/binding.h"
#include "cli/command_files.h"
#include "cli/data/check_json.h"
#include "cli/data/check_text.h"
#include "cli/data/data_commands.h"
#include "cli/data/dataset_json.h"
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

std::string CheckText(const CheckWords& words, const Dataset& data, const CheckReport& report) {
  std::string text =
      fmt::format("check of {}: {} trials, {} channels: {}\n", words.path, report.trials, report.channels,
                  report.findings.empty()       ? "nothing found"
                  : report.findings.size() == 1 ? "1 finding"
                                                : fmt::format("{} findings", report.findings.size()));
  for (const Finding& finding : report.findings) {
    text += Wrapped(text::FindingText(finding), 2);
    const std::string mask = text::MaskText(SuggestMask(data, finding));
    text += Wrapped(text::AdviceText(finding) + (mask.empty() ? "" : " Suggested mask: " + mask + "."), 4);
  }
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

Result<int> Check(const CheckWords& words) {
  if (!words.mask.empty() && words.mask != "auto") return Fail("--mask {}: expected auto", words.mask);
  if (words.mask.empty() && !words.out.empty()) return Fail("--out: nothing is written without --mask auto");
  SINEW_TRY(words.mask.empty() ? CheckFiles({{words.path, words.config}, {}, words.json})
                               : CheckInPlace(words.path, words.out, {words.config}, words.json));
  SINEW_ASSIGN(Dataset data, ReadDataset(words.path));
  CheckReport report = CheckData(data);
  const std::vector<MaskedSpan> mask = SuggestMask(data, report.findings);
  std::string text = CheckText(words, data, report);
  MaskOutcome outcome;
  Dataset masked = data;
  const auto applied = ApplyMask(masked, mask);
  const bool write = words.mask == "auto" && applied && !mask.empty();
  if (write) {
    outcome = *applied;
    const std::string& out = words.out.empty() ? words.path : words.out;
    SINEW_TRY(WriteDataset(out, masked));
    text += MaskedText(out, mask, outcome);
  }
  SINEW_TRY(Report(
      words.json, [&] { return CheckJson(data, report, write ? &outcome : nullptr); }, text));
  if (!applied) {
    std::fprintf(stderr, "sinew: no usable data: %s\n", applied.error().message.c_str());
    return kNotUsable;
  }
  return kDone;
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
