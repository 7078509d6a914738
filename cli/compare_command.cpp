// sinew compare: solvers against each other on one problem, over several starts and seeds.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <utility>

#include "base/numbers.h"
#include "base/text.h"
#include "cli/binding.h"
#include "cli/command.h"
#include "cli/command_files.h"
#include "cli/memory_limit.h"
#include "cli/mpi_ranks.h"
#include "cli/stop_signals.h"
#include "cli/study_checkpoint.h"
#include "cli/terminal.h"
#include "cli/work_times_file.h"
#include "identify/files/origin.h"
#include "identify/files/study_file.h"
#include "identify/files/study_resume.h"
#include "identify/solvers/prior_choice.h"

namespace sinew {
namespace {

struct CompareWords {
  BindingOptions binding;
  FitOptions fit;
  std::vector<std::string> solvers;
  int repeats = 5;
  std::optional<double> target;
  std::string out;
  std::string json;
  bool resume = false;
  std::optional<int> starts;         // of multistart
  std::optional<double> max_memory;  // [MB]
};

// What a run of the comparison follows from. Solvers and repeats may be added when it is resumed.
files::OriginFacts FactsOf(const CompareWords& words) {
  const auto given = [](const auto& limit) {
    return limit ? fmt::format("{}", *limit) : std::string("none");
  };
  return {{"--seed", std::to_string(words.fit.seed)},
          {"--starts", std::to_string(words.starts.value_or(SolverOptions().starts))},
          {"--max-evaluations", given(words.fit.max_evaluations)},
          {"--max-seconds", given(words.fit.max_seconds)}};
}

std::string Number(double value) {
  return std::isnan(value) ? "-" : Readable(value);
}

std::string StudyTable(const Study& study, const Problem& problem) {
  std::vector<std::vector<std::string>> rows{
      {"solver", "success", "cost (median)", "worst", "evaluations", "to target", "time", "to target"}};
  std::vector<std::vector<std::string>> spread{{"solver"}};
  for (const int index : study.free)
    spread[0].push_back(problem.parameters()[static_cast<std::size_t>(index)].name);
  for (const SolverSummary& s : Summarise(study)) {
    rows.push_back({s.solver, fmt::format("{}/{}", s.successes, s.repeats), Readable(s.cost_median, 6),
                    Readable(s.cost_worst, 6), Number(s.evaluations), Number(s.evaluations_to_target),
                    Duration(s.seconds),
                    std::isnan(s.seconds_to_target) ? "-" : Duration(s.seconds_to_target)});
    spread.push_back({s.solver});
    for (std::size_t k = 0; k < s.mean.size(); ++k) {
      spread.back().push_back(Readable(s.mean[k], 5) + " +- " + Readable(s.deviation[k], 2));
    }
  }
  return Table(rows, 2) + "Parameters, mean +- standard deviation over the repeats\n" + Table(spread, 2);
}

Status CheckStarts(const CompareWords& words) {
  if (!words.starts || std::any_of(words.solvers.begin(), words.solvers.end(), HasStarts)) return {};
  return Fail("--starts: they are those of solver multistart, which is not compared");
}

StudyOptions ToOptions(const CompareWords& words) {
  StudyOptions options;
  options.solvers = words.solvers;
  options.repeats = words.repeats;
  options.solver_options = words.fit.ToSolverOptions();
  options.solver_options.starts = words.starts.value_or(options.solver_options.starts);
  if (words.fit.max_evaluations || words.fit.max_seconds) options.budget = words.fit.ToBudget();
  options.target = words.target;
  options.interrupt = &InterruptFlag();
  return options;
}

Result<int> RunCompare(const CompareWords& words) {
  const auto limit = words.fit.LimitThreads();
  SINEW_TRY(CheckStarts(words));
  SINEW_ASSIGN(
      const FileLocks locks,
      ClaimFiles({{words.binding.data, words.binding.config}, words.fit.Written(words.out), words.json},
                 IfBusy::kRefuse));
  SINEW_ASSIGN(const Binding binding, BindToFit(words.binding, !words.fit.release.empty()));
  SINEW_ASSIGN(const FitRequest request, words.fit.Request());
  SINEW_ASSIGN(FitSetup setup, MakeFitSetup(binding.problem(), request));
  const Provenance provenance = binding.ToProvenance(words.binding);
  const Hdf5Node origin = files::OriginTree(provenance, setup, FactsOf(words));
  // Every solver fits with the same priors, from the same starts.
  setup = solvers::WithPriorsOf(solvers::ChoosePriors(binding.problem(), setup, {&InterruptFlag()}).setup,
                                std::move(setup));
  const LeastSquares problem(binding.problem(), setup);

  ProgressLine line("compare", words.fit.quiet);
  StudyOptions options = ToOptions(words);
  options.progress = [&](int done, int all) { line.Show(done, all); };
  if (words.resume && std::filesystem::exists(words.out)) {
    SINEW_ASSIGN(options.done, files::ReadStudyRuns(words.out, setup, origin));
  } else if (words.resume) {
    NoteBeginning(words.out);
  }
  StudyCheckpoint checkpoint({words.out, binding.problem(), provenance, origin, line}, setup, options.done);
  if (!IsHelper()) options.after_run = [&](const StudyRun& run) { checkpoint.AtRun(run); };
  WorkTimesFile work_times(words.fit.work_times);
  options.work = work_times.work();
  StoppableWork work([&] { return checkpoint.SaveNow(); });
  MemoryLimit memory(words.max_memory);
  memory.Begin();
  SINEW_ASSIGN(const Study study, CompareSolvers(problem, options));
  if (IsHelper()) return kDone;
  work.Finish();
  line.Clear();
  SINEW_TRY(work_times.Write());
  if (!study.finished && study.runs.empty())
    return ReportStopped(*words.binding.program, checkpoint.SaveNow());
  if (!std::isfinite(study.best)) {
    return ReportNotUsable(*words.binding.program, "no solver found a point that can be predicted");
  }
  SINEW_TRY(WriteHdf5(words.out, files::StudyTree(binding.problem(), study, provenance, origin)));
  if (!words.json.empty())
    SINEW_TRY(WriteText(words.json, files::StudyJson(binding.problem(), study, provenance)));
  if (words.json != "-") {
    Print(stdout, fmt::format("compare on {} of {} ({}): best cost {}, target {}\n", words.binding.problem,
                              words.binding.data, binding.DescribeData(), Readable(study.best, 6),
                              Readable(study.target, 6)));
    Print(stdout, StudyTable(study, binding.problem()));
    Print(stdout, fmt::format("Study file: {}\n", words.out));
  }
  if (!study.finished)
    return ReportStopped(*words.binding.program, StudyCheckpoint::HowToResume(words.out, study.runs.size()));
  return kDone;
}

}  // namespace

void AddCompareCommand(Command app, const RunAction& run) {
  auto words = std::make_shared<CompareWords>();
  Command command = app.AddCommand("compare", "Compare solvers over several starts and seeds");
  words->binding.AddTo(command);
  words->fit.AddTo(command);
  command.Add("--solvers", words->solvers, "Solvers and chains").Required().Split(',').Shows("A,B,C");
  command
      .Add("--repeats", words->repeats,
           "Runs per solver; the first starts at the problem's start values, the others at random")
      .Between(1, 100000)
      .ShowsDefault();
  command.Add("--target", words->target, "Cost that counts as success; default: within 1 % of the best found")
      .AtLeastZero();
  command.Add("--out", words->out, "Study file to write").Required().Shows("STUDY.h5");
  AddStartsTo(command, words->starts);
  AddMaxMemoryTo(command, words->max_memory, "It stops where the process takes so many MB of memory");
  command.AddFlag("--resume", words->resume,
                  "Continue an interrupted comparison: runs that had ended are kept");
  AddJsonTo(command, words->json);
  command.Runs(run, [=] { return RunCompare(*words); });
}

}  // namespace sinew
