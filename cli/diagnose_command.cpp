// sinew diagnose: what the fitted model still gets wrong, why, and what the cause brings.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <optional>

#include "base/text.h"
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
#include "identify/equal_noise_view.h"
#include "identify/files/diagnosis_file.h"
#include "identify/files/diagnosis_json.h"
#include "identify/files/kept_work.h"
#include "identify/files/origin.h"
#include "identify/files/recorded_cost.h"
#include "identify/text/diagnosis_overview.h"
#include "identify/text/diagnosis_sentences.h"

namespace sinew {
namespace {

struct DiagnoseWords {
  BindingOptions binding;
  FitOptions fit;
  std::string from;
  std::string solver;  // empty: that of the problem
  std::string out;
  std::string json;
  bool resume = false;
  std::optional<double> max_memory;  // [MB]
};

template <class Named>
bool IsNamed(const std::vector<Named>& pairs, const std::string& name) {
  return std::any_of(pairs.begin(), pairs.end(), [&](const Named& pair) { return pair.first == name; });
}

// What a diagnosis follows from besides data, settings, bounds and starts.
files::OriginFacts FactsOf(const DiagnoseWords& words, const FitSetup& setup, const std::string& solver) {
  std::vector<std::string> held;
  for (const int index : setup.held) held.push_back(setup.parameters[static_cast<std::size_t>(index)].name);
  return {{"--seed", std::to_string(words.fit.seed)}, {"--solver", solver}, {"--fix", Join(held, ",")}};
}

// What was done of the diagnosis that is resumed. Errors: no such file, or a finished one; it was made from
// something else.
Result<RecordedRun> Recorded(const std::string& path, const Problem& problem, const FitSetup& setup,
                             const Hdf5Node& origin) {
  SINEW_ASSIGN(const Hdf5Node tree, ReadHdf5(path));
  SINEW_ASSIGN(RecordedRun run, RecordedRunOf(path, tree));
  const Hdf5Node* then = tree.Find("origin");
  if (run.solver != kDiagnoseSolver || then == nullptr)
    return Fail("--resume: {} is no diagnosis that was begun: give another --out", path);
  SINEW_TRY(files::CheckSameOrigin(path, *then, origin));
  const EqualNoiseView equal(problem);
  const Problem& fitted = problem.weights_are_noise_levels() ? problem : equal;
  SINEW_TRY(files::CheckBestCost(path, run, LeastSquares(fitted, setup)));
  return run;
}

// The answer of a run as the start of the base fit: what was free there starts from its value, what was held
// is held, effects as well; words of the command line go before. Errors: another problem or other data, a
// value outside the bounds. @return what must be said about it.
Result<std::vector<Warning>> StartFrom(const DiagnoseWords& words, const Problem& problem,
                                       const Provenance& provenance, FitRequest& request) {
  SINEW_ASSIGN(const RecordedRun run, ReadRun(words.from));
  const auto differs = [&](const char* what, const std::string& then, const std::string& now) {
    return Fail("--from: {} was made with {} {}, not {}", words.from, what, then, now);
  };
  if (run.problem != provenance.problem) return differs("problem", run.problem, provenance.problem);
  if (run.data_hash != provenance.data_hash) return differs("data", run.data_hash, provenance.data_hash);
  if (run.values.empty()) return Fail("--from: {} holds no answer", words.from);
  std::vector<Warning> notes = files::WarningsOfRun(words.from, run, problem, provenance.data_hash);
  std::vector<std::string> released;
  for (const auto& [name, value] : run.values) {
    SINEW_ASSIGN(const int index, FindParameter(problem.parameters(), name));
    const Parameter& p = problem.parameters()[static_cast<std::size_t>(index)];
    const bool was_free = std::find(run.variables.begin(), run.variables.end(), name) != run.variables.end();
    const bool not_at_null = p.kind == ParameterKind::kEffect && value != p.null_value;
    const bool held = not_at_null && !was_free && run.solver != kDiagnoseSolver;
    if (not_at_null && !held) released.push_back(name);
    if (p.kind == ParameterKind::kEffect && !held) continue;
    if (p.kind == ParameterKind::kNuisance && !was_free) continue;
    if (IsNamed(request.fix, name) || IsNamed(request.start, name)) continue;
    if (!IsNamed(request.bounds, name) && !(value >= p.lower && value <= p.upper)) {
      return Fail("--from: {} has {} = {}, outside its bounds {} .. {}; give --bounds as that run had them",
                  words.from, name, value, p.lower, p.upper);
    }
    const bool is_free = std::find(request.free.begin(), request.free.end(), name) != request.free.end();
    if (was_free || is_free) {
      request.start.emplace_back(name, value);
    } else if (request.free.empty()) {
      request.fix.emplace_back(name, value);
    }
  }
  if (!released.empty()) {
    notes.push_back({WarningKind::kOther,
                     {},
                     {},
                     fmt::format("{} had released {}: the diagnosis begins at their null values", words.from,
                                 Join(released, ", "))});
  }
  return notes;
}

void PrintDiagnosis(const DiagnoseWords& words, const Binding& binding, const Diagnosis& diagnosis) {
  Print(stdout, fmt::format("diagnose {} on {} ({})\n", words.binding.problem, words.binding.data,
                            binding.DescribeData()));
  constexpr int kWidth = 100;  // columns
  for (const text::Line& line : text::Overview(diagnosis))
    Print(stdout, Wrapped(line.text, line.indent, kWidth));
  Print(stdout, fmt::format("  Diagnosis file: {}\n", words.out));
}

Result<int> RunDiagnose(const DiagnoseWords& words) {
  const auto limit = words.fit.LimitThreads();
  const Program& program = *words.binding.program;
  SINEW_ASSIGN(const FileLocks locks, ClaimFiles({{words.binding.data, words.binding.config, words.from},
                                                  words.fit.Written(words.out),
                                                  words.json},
                                                 IfBusy::kRefuse));
  SINEW_ASSIGN(const Binding binding, BindToFit(words.binding, true));
  const Provenance provenance = binding.ToProvenance(words.binding);
  SINEW_ASSIGN(FitRequest request, words.fit.Request());
  std::vector<Warning> notes;
  for (const std::string& note : binding.bound.notes) notes.push_back({WarningKind::kOther, {}, {}, note});
  if (!words.from.empty()) {
    SINEW_ASSIGN(const auto more, StartFrom(words, binding.problem(), provenance, request));
    notes.insert(notes.end(), more.begin(), more.end());
  }
  SINEW_ASSIGN(FitSetup setup, MakeFitSetup(binding.problem(), request));

  SolverOptions how;
  how.seed = words.fit.seed;
  if (!words.solver.empty()) SINEW_TRY(MakeSolver(words.solver, how));  // a wrong name writes nothing
  DiagnosisOptions options;
  options.solver = words.solver;
  options.seed = words.fit.seed;
  options.threads = words.fit.threads;
  options.interrupt = &InterruptFlag();
  WorkTimesFile work_times(words.fit.work_times);
  FitRecord record;
  record.Share(work_times.work());
  options.record = &record;
  options.base_search.most_kept = kMostKept;
  const std::string solver = words.solver.empty() ? binding.problem().default_solver() : words.solver;
  const Hdf5Node origin = files::OriginTree(provenance, setup, FactsOf(words, setup, solver));
  if (words.resume && std::filesystem::exists(words.out)) {
    SINEW_ASSIGN(RecordedRun run, Recorded(words.out, binding.problem(), setup, origin));
    options.base_search.replay = std::move(run.record);
    options.base_search.finished = std::move(run.finished_searches);
    options.base_search.replayed_residuals = std::move(run.kept_residuals);
    record.Restore(std::move(run.fits));
  } else if (words.resume) {
    NoteBeginning(words.out);
  }
  ProgressLine line("diagnose", words.fit.quiet);
  options.progress = [&](const DiagnosisProgress& now) { line.Show(text::ProgressText(now)); };
  RunCheckpoint checkpoint({words.out, kDiagnoseSolver, words.fit.seed, provenance, &origin, record, line},
                           options.base_search.replay.evaluations());
  std::string how_to_go_on;
  if (!IsHelper()) {
    options.base_search.watch = checkpoint.watch();
    options.base_search.progress = [&](const Progress&, const Evaluator&) { checkpoint.SaveIfDue(); };
    record.after_keep = [&] { checkpoint.SaveIfDue(); };
    options.at_end = [&] {
      if (InterruptFlag()) how_to_go_on = checkpoint.SaveNow();
    };
  }
  StoppableWork work([&] { return checkpoint.SaveNow(); });
  MemoryLimit memory(words.max_memory);
  memory.Begin();
  auto result = Diagnose(binding.problem(), std::move(setup), options);
  if (IsHelper()) return kDone;
  const bool interrupted = work.Finish() != 0;
  line.Clear();
  SINEW_TRY(work_times.Write());
  if (interrupted) return ReportStopped(program, how_to_go_on);
  if (!result) return tl::unexpected(result.error());
  Diagnosis& diagnosis = *result;
  for (Warning& note : notes) diagnosis.warnings.push_back(std::move(note));
  for (Warning& warning : DataWarnings(binding.data, binding.problem().layout(), words.binding.data))
    diagnosis.warnings.push_back(std::move(warning));

  SINEW_ASSIGN(Hdf5Node tree, DiagnosisTree(binding.problem(), diagnosis, provenance, options));
  // A job that is put back into a queue after its end repeats its answer without the fits.
  tree.At("origin") = origin;
  files::WriteKeptWork({}, &record, tree);
  SINEW_TRY(WriteHdf5(words.out, tree));
  if (words.json != "-") PrintDiagnosis(words, binding, diagnosis);
  if (!words.json.empty())
    SINEW_TRY(WriteText(words.json, files::DiagnosisJson(diagnosis, provenance, options)));
  if (!diagnosis.concluded()) return ReportNotUsable(program, text::WhyInconclusive(diagnosis));
  return kDone;
}

}  // namespace

void AddDiagnoseCommand(Command app, const RunAction& run) {
  auto words = std::make_shared<DiagnoseWords>();
  Command command = app.AddCommand(
      "diagnose", "Find what the fitted model still gets wrong, the cause, and the gain on held-out trials");
  words->binding.AddTo(command);
  words->fit.AddChoiceTo(command);
  words->fit.AddWorkTo(command);
  command.Add("--from", words->from, "Start the base fit from the answer of a run file").Shows("RUN.h5");
  command.Add("--solver", words->solver, "Of the base fit; default: the problem's own, mostly restarts")
      .Shows("S");
  AddMaxMemoryTo(command, words->max_memory, "It stops where the process takes so many MB of memory");
  command.AddFlag("--resume", words->resume,
                  "Continue an interrupted diagnosis: refits that were done are kept");
  command.Add("--out", words->out, "Diagnosis file to write (docs/run_file.md)").Required().Shows("DIAG.h5");
  AddJsonTo(command, words->json);
  command.Runs(run, [=] { return RunDiagnose(*words); });
}

}  // namespace sinew
