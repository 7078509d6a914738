// sinew run: the same steps for every subject of a cohort.
#include <cstdio>
#include <filesystem>

#include "base/replace_file.h"
#include "cli/cohort/cohort_run.h"
#include "cli/cohort/pipeline.h"
#include "cli/cohort/summary.h"
#include "cli/command.h"
#include "cli/command_files.h"
#include "cli/mpi_ranks.h"
#include "cli/stop_signals.h"
#include "cli/terminal.h"
#include "cli/work_options.h"

namespace sinew {
namespace {

struct CohortWords : WorkOptions {
  std::string pipeline;
  std::string json;
};

Result<int> RunPipeline(const CohortWords& words, const Program& program) {
  SINEW_ASSIGN(const cohort::Pipeline pipeline, cohort::ReadPipeline(words.pipeline, program));
  cohort::CohortOptions options;
  options.threads = words.threads;
  options.ranks = TheRanks();
  if (IsHelper()) {
    cohort::Children children;
    const StoppableWork work([] { return std::string(); }, [&](int signal) { children.Stop(signal); });
    cohort::HelpWithCohort(pipeline, program, options, children, [] { return StopStatus() != 0; });
    return kDone;
  }
  const std::string folder = pipeline.Located(pipeline.out);
  std::error_code code;
  std::filesystem::create_directories(folder, code);
  if (code) return Fail("{}: {}", folder, code.message());
  const std::string page = folder + "/index.html";
  SINEW_ASSIGN(const FileLocks locks, ClaimFiles({{words.pipeline}, {page}, words.json}, IfBusy::kRefuse));

  cohort::Children children;
  ProgressLine line("run", words.quiet);
  options.progress = [&](int done, int all) { line.Show(done, all); };
  // The commands, which get the signal too, save what they have: we wait for that.
  StoppableWork work([] { return std::string(); }, [&](int signal) { children.Stop(signal); });
  work.Finish();
  if (StopStatus() != 0) children.Stop(StopStatus() - 128);  // it came before it could be passed on
  SINEW_ASSIGN(auto results, cohort::RunCohort(pipeline, program, options, children));
  line.Clear();
  const cohort::Summary summary = cohort::Summarise(pipeline, std::move(results));
  SINEW_TRY(ReplaceFile(page, cohort::SummaryPage(summary)));
  if (words.json != "-") Print(stdout, cohort::SummaryText(summary) + fmt::format("  Page: {}\n", page));
  if (!words.json.empty()) SINEW_TRY(WriteText(words.json, cohort::SummaryJson(summary)));
  if (StopStatus() != 0) {
    const int done = summary.CountOf(cohort::Outcome::kDone) + summary.CountOf(cohort::Outcome::kKept);
    return ReportStopped(program, fmt::format("; {} of {} steps are done: the same command goes on", done,
                                              pipeline.tasks.size()));
  }
  const int failed = summary.CountOf(cohort::Outcome::kFailed);
  if (failed > 0)
    return ReportNotUsable(program, fmt::format("{} step{} failed", failed, failed == 1 ? "" : "s"));
  return kDone;
}

}  // namespace

void AddCohortCommand(Command app, const RunAction& run) {
  auto words = std::make_shared<CohortWords>();
  Command command = app.AddCommand(
      "run", "The same steps for every subject of a cohort; what is done is kept (docs/cohorts.md)");
  command.Add("pipeline", words->pipeline, "Subjects and steps").Required().Shows("PIPELINE.yaml");
  words->AddThreadsTo(command);
  words->AddQuietTo(command);
  AddJsonTo(command, words->json);
  command.Runs(run, [=, program = &app.program()] { return RunPipeline(*words, *program); });
}

}  // namespace sinew
