// sinew list: what there is.
#include <algorithm>
#include <cstdio>

#include "base/numbers.h"
#include "base/text.h"
#include "cli/binding.h"
#include "cli/command.h"
#include "cli/command_files.h"
#include "cli/list_json.h"
#include "cli/run_command_line.h"
#include "cli/terminal.h"
#include "identify/solvers/solver.h"
#include "models/mechanisms/integrator.h"
#include "problems/registry.h"

namespace sinew {
namespace {

struct ListWords {
  std::string what = "problems";
  std::string problem;
  std::string data;
  std::string json;
};

std::string ListProblems(const Program& program) {
  std::vector<std::vector<std::string>> rows;
  for (const ProblemEntry& entry : program.problems) rows.push_back({entry.name, entry.description});
  return Table(rows, 0);
}

std::string ListSolvers() {
  std::vector<std::vector<std::string>> rows{{"solver", "search", "needs", "constraints", "description"}};
  for (const SolverEntry& entry : SolverRegistry()) {
    rows.push_back({entry.name, entry.global ? "global" : "local", entry.gradient ? "Jacobian" : "values",
                    entry.constraints ? "yes" : "no", entry.description});
  }
  return Table(rows, 0) + "Join them into a chain with '+': sa+ceres starts ceres from the answer of sa.\n";
}

std::string ListIntegrators() {
  std::vector<std::vector<std::string>> rows{{"integrator", "description"}};
  for (const IntegratorEntry& entry : IntegratorRegistry()) rows.push_back({entry.name, entry.description});
  return Table(rows, 0) + "What uses them: sinew mbs.\n";
}

const std::vector<FormatEntry> kFormats{
    {".h5", true, true, "data sets and runs of sinew (docs/dataset_file.md, docs/run_file.md)"},
    {".trc", true, false, "markers"},
    {".mot .sto", true, true, "forces, coordinates, anything over time (OpenSim, SIMM, CEINMS)"},
    {".csv .txt", true, false, "anything, with an import map (docs/import.md)"},
    {".osim", true, false, "OpenSim models 2.x to 4.x: bodies, joints, couplers, markers"},
    {".xml", true, false, "OpenSim external loads and inverse kinematics setups"},
    {".obj", true, false, "soles"}};

std::string ListFormats() {
  std::vector<std::vector<std::string>> rows{{"format", "read", "written", "holds"}};
  for (const FormatEntry& format : kFormats)
    rows.push_back({format.name, format.read ? "yes" : "no", format.written ? "yes" : "no", format.holds});
  return Table(rows, 0);
}

std::string ParameterTable(const std::vector<Parameter>& parameters) {
  std::vector<std::vector<std::string>> rows{
      {"parameter", "unit", "lower", "upper", "start", "scale", "meaning", "source"}};
  for (const Parameter& p : parameters) {
    rows.push_back({p.name, p.unit, Readable(p.lower), Readable(p.upper), Readable(p.start),
                    p.scale == Scale::kLog ? "log" : "linear", p.meaning, p.source});
  }
  return Table(rows, 0);
}

std::string ListParameters(const ProblemEntry& entry) {
  std::string text =
      ParameterTable(entry.parameters()) + "\nsinew data synthesize " + entry.name + " --set takes:\n";
  std::vector<std::vector<std::string>> settings;
  for (const auto& [name, description] : entry.experiment()) settings.push_back({name, description});
  return text + Table(settings, 2);
}

std::string Nulls(const Problem& problem, const Effect& effect) {
  std::vector<std::string> nulls;
  for (const int index : effect.parameters) {
    const Parameter& p = problem.parameters()[static_cast<std::size_t>(index)];
    nulls.push_back(
        fmt::format("{} = {}{}", p.name, Readable(p.null_value), p.unit == "1" ? "" : " " + p.unit));
  }
  return Join(nulls, ", ");
}

// One paragraph per effect: tables of sentences would be wider than any terminal.
std::string DescribeEffects(const Problem& problem) {
  std::string text;
  std::string of_one_trial;
  for (const Effect& effect : problem.effects()) {
    if (!effect.trial.empty()) {
      of_one_trial += (of_one_trial.empty() ? "" : ", ") + effect.name;
      continue;
    }
    text += fmt::format("{}  [{}]\n", effect.name, ToString(effect.level));
    text += Wrapped(effect.description, 2);
    text += Wrapped("null: " + Nulls(problem, effect), 2);
    if (!effect.revealing_experiment.empty())
      text += Wrapped("revealed by: " + effect.revealing_experiment, 2);
  }
  if (!of_one_trial.empty()) text += Wrapped("Of one trial alone: " + of_one_trial, 0);
  std::vector<std::string> terms;
  for (const DiscrepancyPort& port : problem.ports()) {
    for (const DiscrepancyTerm& term : port.terms) terms.push_back(term.name);
  }
  if (!terms.empty()) text += Wrapped("Unknown terms: " + Join(terms, ", "), 0);
  return text;
}

// Without data the problem is bound to an experiment that it synthesizes; a problem whose synthetic data need
// another step first cannot be.
Result<BoundProblem> BindToSynthetic(const ProblemEntry& entry) {
  if (entry.synthesize == nullptr) return Fail("the problem '{}' makes none", entry.name);
  SINEW_ASSIGN(const Dataset data, entry.synthesize({}));
  const auto settings = data.files.find(entry.name + ".yaml");
  SINEW_ASSIGN(const YamlReader reader,
               YamlReader::Parse(settings == data.files.end() ? "" : settings->second, entry.name + ".yaml"));
  return entry.bind(data, reader, true);
}

// What a problem's parameters, effects and channels are read from: the data, or synthetic ones.
Result<BoundProblem> BindFor(const Program& program, const ProblemEntry& entry, const ListWords& words) {
  if (words.data.empty()) {
    auto synthetic = BindToSynthetic(entry);
    if (synthetic) return synthetic;
    return Fail("list {} {}: depends on data, give --data F.h5 (synthetic data alone do not do: {})",
                words.what, entry.name, synthetic.error().message);
  }
  BindingOptions options;
  options.problem = entry.name;
  options.program = &program;
  options.data = words.data;
  SINEW_ASSIGN(Binding binding, Bind(options, words.what == "effects"));
  return std::move(binding.bound);
}

std::string ListEffects(const Program& program, const ProblemEntry& entry, const Problem& problem) {
  return DescribeEffects(problem) + "`" + program.name + " identify " + entry.name +
         " --release EFFECT` fits one; `" + program.name + " diagnose` tests which are needed.\n";
}

// What a class of a user's own compares.
std::string ListBlocks(const Problem& problem) {
  std::vector<std::vector<std::string>> rows{{"trial", "channel", "unit", "role", "samples"}};
  for (const Block& block : problem.layout()) {
    rows.push_back(
        {block.trial, block.channel, block.unit, ToString(block.role), std::to_string(block.samples())});
  }
  return Table(rows, 0);
}

const std::vector<std::string> kSubjects{"problems", "solvers",    "integrators", "formats",
                                         "effects",  "parameters", "channels"};

// A user's own problem has no parameter list without data.
bool NeedsData(const ProblemEntry& entry, const std::string& what) {
  return what == "effects" || (what == "parameters" && entry.parameters == nullptr) ||
         (what == "channels" && entry.channels.empty());
}

// What there is of a problem: text for people or, if `as_json`, for machines.
Result<std::string> ListOfProblem(const Program& program, const ListWords& words, bool as_json) {
  if (words.problem.empty())
    return Fail("list {}: expected a problem, such as `sinew list {} contact`", words.what, words.what);
  SINEW_ASSIGN(const ProblemEntry* entry, FindProblem(program.problems, words.problem));
  if (!NeedsData(*entry, words.what)) {
    if (!words.data.empty()) return Fail("--data: list {} takes none, only list effects does", words.what);
    if (words.what == "parameters") return as_json ? ParametersJson(*entry) : ListParameters(*entry);
    return as_json ? ChannelsJson(*entry) : entry->channels;
  }
  SINEW_ASSIGN(const BoundProblem bound, BindFor(program, *entry, words));
  const Problem& problem = *bound.problem;
  if (words.what == "parameters")
    return as_json ? ParametersJson(*entry, problem.parameters()) : ParameterTable(problem.parameters());
  if (words.what == "channels") return as_json ? BlocksJson(*entry, problem) : ListBlocks(problem);
  return as_json ? EffectsJson(*entry, problem) : ListEffects(program, *entry, problem);
}

Result<std::string> ListOf(const Program& program, const ListWords& words, bool as_json) {
  if (std::find(kSubjects.begin(), kSubjects.end(), words.what) == kSubjects.end())
    return Fail("list: '{}' does not exist{}", words.what, Suggestion(words.what, kSubjects));
  const bool of_problem = words.what == "effects" || words.what == "parameters" || words.what == "channels";
  if (!words.problem.empty() && !of_problem)
    return Fail("list {}: unexpected argument '{}'", words.what, words.problem);
  if (!words.data.empty() && !of_problem)
    return Fail("--data: list {} takes none, only list effects does", words.what);
  if (words.what == "solvers") return as_json ? SolversJson() : ListSolvers();
  if (words.what == "integrators") return as_json ? IntegratorsJson() : ListIntegrators();
  if (words.what == "formats") return as_json ? FormatsJson(kFormats) : ListFormats();
  if (words.what == "problems") return as_json ? ProblemsJson(program.problems) : ListProblems(program);
  return ListOfProblem(program, words, as_json);
}

Result<int> List(const Program& program, const ListWords& words) {
  SINEW_ASSIGN(const FileLocks locks, ClaimFiles({{words.data}, {}, words.json}));
  if (!words.json.empty()) {
    SINEW_ASSIGN(const std::string json, ListOf(program, words, true));
    SINEW_TRY(WriteText(words.json, json));
  }
  if (words.json != "-") {
    SINEW_ASSIGN(const std::string text, ListOf(program, words, false));
    Print(stdout, text);
  }
  return kDone;
}

}  // namespace

void AddListCommand(Command app, const RunAction& run) {
  Command command = app.AddCommand(
      "list", "List problems, solvers, formats, and the parameters, effects and channels of a problem");
  auto words = std::make_shared<ListWords>();
  command.Add("what", words->what, "One of " + Join(kSubjects, ", ")).ShowsDefault();
  const Program& program = app.program();
  const bool alone = program.problems.size() == 1;
  command.Add("problem", words->problem, "For effects, parameters and channels");
  command.Add("--data", words->data, "For effects: of these data; else of synthetic ones").Shows("F.h5");
  AddJsonTo(command, words->json);
  command.Runs(run, [=, &program] {
    const bool of_problem =
        words->what == "effects" || words->what == "parameters" || words->what == "channels";
    if (alone && of_problem && words->problem.empty()) words->problem = program.problems.front().name;
    return List(program, *words);
  });
}

}  // namespace sinew
