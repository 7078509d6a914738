// sinew identify: data and a problem in, parameters with verdicts out.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <optional>

#include "base/numbers.h"
#include "base/text.h"
#include "base/version.h"
#include "cli/binding.h"
#include "cli/command.h"
#include "cli/command_files.h"
#include "cli/data/data_warnings.h"
#include "cli/memory_limit.h"
#include "cli/mpi_ranks.h"
#include "cli/run_checkpoint.h"
#include "cli/stop_signals.h"
#include "cli/terminal.h"
#include "cli/work_times_file.h"
#include "identify/files/recorded_cost.h"
#include "identify/identification/identification.h"
#include "identify/identification/stepwise.h"
#include "identify/text/findings.h"
#include "identify/text/warnings.h"

namespace sinew {
namespace {

struct IdentifyWords {
  BindingOptions binding;
  FitOptions fit;
  std::string out;
  std::string solver;  // empty: that of the problem
  std::string json;
  bool resume = false;
  bool stepwise = false;
  std::string intervals = "profile";
  std::optional<int> starts;         // of multistart
  std::optional<double> max_memory;  // [MB]
};

Status TakeStarts(const IdentifyWords& words, const std::string& solver, SolverOptions& options) {
  if (!words.starts) return {};
  if (!HasStarts(solver)) return Fail("--starts: they are those of solver multistart, and not of {}", solver);
  options.starts = *words.starts;
  return {};
}

// The recorded points lie between 0 and 1: under other bounds the same numbers are other parameters.
Status CheckSameParameters(const std::string& path, const Hdf5Node& recorded, const FitSetup& setup) {
  const auto column = [&](const char* name) {
    const Hdf5Node* node = recorded.Find(std::string("parameters/") + name);
    const bool fits = node != nullptr && node->array() != nullptr &&
                      node->array()->values.size() == setup.parameters.size();
    return fits ? node->array()->values : std::vector<double>(setup.parameters.size(), NAN);
  };
  const auto lower = column("lower");
  const auto upper = column("upper");
  const auto start = column("start");
  for (std::size_t i = 0; i < setup.parameters.size(); ++i) {
    const Parameter& p = setup.parameters[i];
    if (lower[i] == p.lower && upper[i] == p.upper && start[i] == p.start) continue;
    return Fail("--resume: {} was made with bounds {} .. {} and start {} of '{}', not {} .. {} and {}", path,
                lower[i], upper[i], start[i], p.name, p.lower, p.upper, p.start);
  }
  return {};
}

// Parameters of priors, which that run has chosen.
std::vector<std::pair<std::string, double>> PriorsOf(const RecordedRun& run, const FitSetup& setup) {
  std::vector<std::pair<std::string, double>> priors;
  for (const auto& [name, value] : run.values) {
    const auto index = FindParameter(setup.parameters, name);
    if (index && setup.parameters[static_cast<std::size_t>(*index)].kind == ParameterKind::kPrior)
      priors.emplace_back(name, value);
  }
  return priors;
}

// The evaluations of the run that is resumed. Errors: no such run; it was made from something else, so that
// its evaluations are not those of this one.
Result<RecordedRun> Recorded(const IdentifyWords& words, const std::string& solver,
                             const Provenance& provenance, const Problem& problem, const FitSetup& setup) {
  SINEW_ASSIGN(const Hdf5Node tree, ReadHdf5(words.out));
  auto recorded = RecordedRunOf(words.out, tree);
  if (!recorded) return tl::unexpected(recorded.error());
  const auto differs = [&](const char* what, const std::string& then, const std::string& now) {
    return Fail("--resume: {} was made with {} {}, not {}", words.out, what, then, now);
  };
  if (recorded->problem != provenance.problem)
    return differs("problem", recorded->problem, provenance.problem);
  if (recorded->version != kVersion) return differs("version", recorded->version, kVersion);
  if (recorded->solver != solver) return differs("solver", recorded->solver, solver);
  if (recorded->starts != 0 && recorded->starts != provenance.starts)
    return differs("--starts", std::to_string(recorded->starts), std::to_string(provenance.starts));
  if (recorded->data_hash != provenance.data_hash)
    return differs("data", recorded->data_hash, provenance.data_hash);
  if (recorded->seed != words.fit.seed) {
    return differs("seed", std::to_string(recorded->seed), std::to_string(words.fit.seed));
  }
  std::vector<std::string> names;
  for (const int index : setup.free) names.push_back(setup.parameters[static_cast<std::size_t>(index)].name);
  if (recorded->variables != names)
    return differs("free parameters", Join(recorded->variables, ","), Join(names, ","));
  const Hdf5Node* config = tree.Find("run/config");
  if (config == nullptr || config->text() == nullptr || *config->text() != provenance.config)
    return Fail("--resume: {} was made with other settings (--config); they are in its /run/config",
                words.out);
  if (tree.Find("parameters") != nullptr) SINEW_TRY(CheckSameParameters(words.out, tree, setup));
  FitSetup then = setup;
  for (const auto& [name, value] : PriorsOf(*recorded, setup)) {
    SINEW_ASSIGN(const int index, FindParameter(setup.parameters, name));
    then.rest[index] = value;
  }
  SINEW_TRY(files::CheckBestCost(words.out, *recorded, LeastSquares(problem, then)));
  return recorded;
}

// The cost and what it is, then the problem's own figures of merit.
std::vector<std::string> Figures(const Problem& problem, const Identification& identification) {
  if (!identification.result.stop.usable()) return {};
  std::vector<std::string> lines{
      fmt::format("cost {}: {}", Readable(identification.result.cost, 4), problem.objective())};
  for (const FigureOfMerit& figure : identification.figures)
    lines.push_back(fmt::format("{} {}: {}", figure.name, Readable(figure.value, 4), text::Meaning(figure)));
  return lines;
}

std::string Headline(const Identification& identification) {
  const SolverResult& result = identification.result;
  double solving = identification.seconds;
  double intervals = identification.interval_seconds;
  auto evaluations = static_cast<std::size_t>(identification.record.evaluations());
  for (const FinishedStep& step : identification.steps) {
    solving += step.seconds;
    intervals += step.interval_seconds;
    evaluations += step.evaluations;
  }
  const std::string after = intervals > 0 ? ", intervals " + Duration(intervals) : "";
  return fmt::format("{}  {} evaluations  {}{}   {}: {}", identification.solver, evaluations,
                     Duration(solving), after, result.stop.converged() ? "converged" : "NOT converged",
                     result.stop.test);
}

void PrintFindings(const IdentifyWords& words, const Binding& binding, const Identification& identification) {
  Print(stdout, fmt::format("identify {} on {} ({})\n", words.binding.problem, words.binding.data,
                            binding.DescribeData()));
  Print(stdout, Wrapped(Headline(identification), 2));
  for (const std::string& line : Figures(binding.problem(), identification)) Print(stdout, Wrapped(line, 2));
  for (const text::Sentence& finding : text::Findings(identification))
    Print(stdout, Wrapped(finding.text, 2));
  for (const std::string& warning : text::Warnings(identification))
    Print(stdout, Wrapped("warning: " + warning, 2));
  Print(stdout, fmt::format("  Run file: {}\n", words.out));
}

Result<int> RunIdentify(const IdentifyWords& words) {
  const auto limit = words.fit.LimitThreads();
  SINEW_ASSIGN(
      const FileLocks locks,
      ClaimFiles({{words.binding.data, words.binding.config}, words.fit.Written(words.out), words.json},
                 IfBusy::kRefuse));
  SINEW_ASSIGN(const Binding binding, BindToFit(words.binding, !words.fit.release.empty()));
  SINEW_ASSIGN(const FitRequest request, words.fit.Request());
  SINEW_ASSIGN(FitSetup setup, MakeFitSetup(binding.problem(), request));
  Provenance provenance = binding.ToProvenance(words.binding);

  IdentificationOptions options;
  options.solver = words.solver.empty() ? binding.problem().default_solver() : words.solver;
  options.solver_options = words.fit.ToSolverOptions();
  SINEW_TRY(TakeStarts(words, options.solver, options.solver_options));
  if (HasStarts(options.solver)) provenance.starts = options.solver_options.starts;
  options.evaluator.budget = words.fit.ToBudget();
  if (words.max_memory) options.evaluator.budget.max_memory = 1e6 * *words.max_memory;
  options.evaluator.interrupt = &InterruptFlag();
  if (words.intervals != "profile" && words.intervals != "linear")
    return Fail("--intervals: '{}'{}", words.intervals, Suggestion(words.intervals, {"profile", "linear"}));
  options.profiles = words.intervals == "profile";
  options.evaluator.most_kept = kMostKept;
  WorkTimesFile work_times(words.fit.work_times);
  FitRecord record;
  record.Share(work_times.work());
  if (!words.stepwise) setup.record = &record;
  SINEW_TRY(MakeSolver(options.solver, options.solver_options));  // a wrong name writes nothing
  if (words.resume && words.stepwise) return Fail("--resume: steps are done again, not resumed");
  if (words.resume && !std::filesystem::exists(words.out)) {
    NoteBeginning(words.out);
  } else if (words.resume) {
    SINEW_ASSIGN(RecordedRun recorded, Recorded(words, options.solver, provenance, binding.problem(), setup));
    options.replayed_priors = PriorsOf(recorded, setup);
    options.evaluator.replay = std::move(recorded.record);
    options.evaluator.finished = std::move(recorded.finished_searches);
    options.evaluator.replayed_residuals = std::move(recorded.kept_residuals);
    record.Restore(std::move(recorded.fits));
  }

  ProgressLine line("identify " + options.solver, words.fit.quiet);
  RunCheckpoint checkpoint({words.out, options.solver, words.fit.seed, provenance, nullptr, record, line},
                           options.evaluator.replay.evaluations());
  if (!IsHelper()) {
    options.evaluator.watch = checkpoint.watch();
    options.evaluator.progress = [&](const Progress& progress, const Evaluator& evaluator) {
      line.Show(progress, evaluator.options().budget);
      checkpoint.SaveIfDue();
    };
    record.after_keep = [&] { checkpoint.SaveIfDue(); };
  }
  StoppableWork work([&] { return checkpoint.SaveNow(); });
  // Of steps nothing is kept. A search that has used its memory has its answer: linear intervals take no
  // more.
  MemoryLimit memory(words.stepwise ? std::nullopt : words.max_memory);
  options.after_search = [&](const SolverResult& found) {
    if (found.stop.usable() && found.stop.kind != Termination::kMaxMemory) memory.Begin();
  };
  SINEW_ASSIGN(Identification identification,
               words.stepwise ? IdentifyStepwise(binding.problem(), request, options)
                              : Identify(binding.problem(), std::move(setup), std::move(options)));
  if (IsHelper()) return kDone;
  work.Finish();
  line.Clear();
  SINEW_TRY(work_times.Write());
  // Stopped while it still repeated what it resumes: the file holds more.
  if (identification.interrupted && checkpoint.IsBehind(identification.record.evaluations()))
    return ReportStopped(*words.binding.program, checkpoint.SaveNow());
  for (const std::string& note : binding.bound.notes)
    identification.warnings.push_back({WarningKind::kOther, {}, {}, note});
  for (Warning& warning : DataWarnings(binding.data, binding.problem().layout(), words.binding.data))
    identification.warnings.push_back(std::move(warning));

  SINEW_ASSIGN(const Hdf5Node tree, RunTree(binding.problem(), identification, provenance));
  SINEW_TRY(WriteHdf5(words.out, tree));
  if (words.json != "-") PrintFindings(words, binding, identification);
  if (!words.json.empty())
    SINEW_TRY(WriteText(words.json, RunJson(binding.problem(), identification, provenance)));
  if (identification.interrupted) {
    return ReportStopped(*words.binding.program, checkpoint.HowToResume(identification.record.evaluations()));
  }
  if (!identification.result.stop.usable()) {
    return ReportNotUsable(*words.binding.program, identification.result.stop.test);
  }
  return kDone;
}

}  // namespace

void AddIdentifyCommand(Command app, const RunAction& run) {
  auto words = std::make_shared<IdentifyWords>();
  Command command = app.AddCommand("identify", "Find the parameters that explain the training trials");
  words->binding.AddTo(command);
  words->fit.AddTo(command);
  command.Add("--out", words->out, "Run file to write (docs/run_file.md)").Required().Shows("RUN.h5");
  command
      .Add("--solver", words->solver,
           "One of `sinew list solvers`, or a chain a+b; default: the problem's own, mostly restarts")
      .Shows("S");
  AddStartsTo(command, words->starts);
  AddMaxMemoryTo(command, words->max_memory,
                 "Budget: the search ends where the process takes so many MB of memory, the intervals stop");
  command.AddFlag("--resume", words->resume, "Continue an interrupted run; the result is the same");
  command
      .Add("--intervals", words->intervals,
           "How 95 % intervals are found: profile likelihood, or from the curvature alone (much faster)")
      .Shows("profile|linear");
  command.AddFlag("--stepwise", words->stepwise, "Fit in the steps that the settings list");
  AddJsonTo(command, words->json);
  command.Runs(run, [=] { return RunIdentify(*words); });
}

}  // namespace sinew
