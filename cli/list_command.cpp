// sinew list: what there is.
#include <algorithm>
#include <cstdio>

#include "base/numbers.h"
#include "base/text.h"
#include "cli/binding.h"
#include "cli/command.h"
#include "cli/run_command_line.h"
#include "cli/terminal.h"
#include "identify/solvers/solver.h"
#include "models/mechanisms/integrator.h"
#include "problems/registry.h"

namespace sinew {
namespace {

void Print(const std::string& text) {
  std::fputs(text.c_str(), stdout);
}

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

std::string ListFormats() {
  return Table(
      {{"format", "read", "written", "holds"},
       {".h5", "yes", "yes", "data sets and runs of sinew (docs/dataset_file.md, docs/run_file.md)"},
       {".trc", "yes", "no", "markers"},
       {".mot .sto", "yes", "yes", "forces, coordinates, anything over time (OpenSim, SIMM, CEINMS)"},
       {".csv .txt", "yes", "no", "anything, with an import map (docs/import.md)"},
       {".osim", "yes", "no", "OpenSim models 2.x to 4.x: bodies, joints, couplers, markers"},
       {".xml", "yes", "no", "OpenSim external loads and inverse kinematics setups"},
       {".obj", "yes", "no", "soles"}},
      0);
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

// A problem that is bound to data or, without, to an experiment of its own.
Result<BoundProblem> BindFor(const Program& program, const ProblemEntry& entry, const std::string& data,
                             bool with_sensor_effects);

Result<std::string> ListParameters(const Program& program, const ProblemEntry& entry,
                                   const std::string& data) {
  if (entry.parameters == nullptr) {
    SINEW_ASSIGN(const BoundProblem bound, BindFor(program, entry, data, false));
    return ParameterTable(bound.problem->parameters());
  }
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
      text += Wrapped("exposed by: " + effect.revealing_experiment, 2);
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

Result<BoundProblem> BindFor(const Program& program, const ProblemEntry& entry, const std::string& data,
                             bool with_sensor_effects) {
  if (data.empty()) {
    auto synthetic = BindToSynthetic(entry);
    if (synthetic) return synthetic;
    return Fail("list: {} depends on data, give --data F.h5 (synthetic data alone do not do: {})", entry.name,
                synthetic.error().message);
  }
  BindingOptions options;
  options.problem = entry.name;
  options.program = &program;
  options.data = data;
  SINEW_ASSIGN(Binding binding, Bind(options, with_sensor_effects));
  return std::move(binding.bound);
}

Result<std::string> ListEffects(const Program& program, const ProblemEntry& entry, const std::string& data) {
  SINEW_ASSIGN(const BoundProblem bound, BindFor(program, entry, data, true));
  return DescribeEffects(*bound.problem) + "`" + program.name + " identify " + entry.name +
         " --release EFFECT` fits one; `" + program.name + " diagnose` asks which are needed.\n";
}

// What a class of a user's own compares, read off the data.
Result<std::string> ListChannels(const Program& program, const ProblemEntry& entry, const std::string& data) {
  if (!entry.channels.empty()) return entry.channels;
  SINEW_ASSIGN(const BoundProblem bound, BindFor(program, entry, data, false));
  std::vector<std::vector<std::string>> rows{{"trial", "channel", "unit", "role", "samples"}};
  for (const Block& block : bound.problem->layout()) {
    rows.push_back(
        {block.trial, block.channel, block.unit, ToString(block.role), std::to_string(block.samples())});
  }
  return Table(rows, 0);
}

const std::vector<std::string> kSubjects{"problems", "solvers",    "integrators", "formats",
                                         "effects",  "parameters", "channels"};

Result<int> List(const Program& program, const std::string& what, const std::string& problem,
                 const std::string& data) {
  if (std::find(kSubjects.begin(), kSubjects.end(), what) == kSubjects.end())
    return Fail("list: '{}' does not exist{}", what, Suggestion(what, kSubjects));
  if (what == "solvers") {
    Print(ListSolvers());
  } else if (what == "integrators") {
    Print(ListIntegrators());
  } else if (what == "formats") {
    Print(ListFormats());
  } else if (what == "problems") {
    Print(ListProblems(program));
  } else {
    if (problem.empty())
      return Fail("list {}: expected a problem, such as `sinew list {} contact`", what, what);
    SINEW_ASSIGN(const ProblemEntry* entry, FindProblem(program.problems, problem));
    const auto of = what == "parameters" ? ListParameters : what == "channels" ? ListChannels : ListEffects;
    SINEW_ASSIGN(const std::string text, of(program, *entry, data));
    Print(text);
  }
  return kDone;
}

}  // namespace

void AddListCommand(Command app, const RunAction& run) {
  Command command =
      app.AddCommand("list", "What there is: problems, solvers, formats, and a problem's parts");
  auto what = std::make_shared<std::string>("problems");
  auto problem = std::make_shared<std::string>();
  const Program& program = app.program();
  if (program.problems.size() == 1) *problem = program.problems.front().name;
  command.Add("what", *what, "One of " + Join(kSubjects, ", ")).ShowsDefault();
  command.Add("problem", *problem, "For effects, parameters and channels");
  auto data = std::make_shared<std::string>();
  command.Add("--data", *data, "Of these data; else of synthetic ones").Shows("F.h5");
  command.Runs(run, [=, &program] { return List(program, *what, *problem, *data); });
}

}  // namespace sinew
