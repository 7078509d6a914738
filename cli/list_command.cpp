// sinew list: what there is.
#include <algorithm>
#include <cstdio>

#include "base/numbers.h"
#include "base/text.h"
#include "cli/command.h"
#include "cli/terminal.h"
#include "identify/solvers/solver.h"
#include "problems/registry.h"

namespace sinew {
namespace {

void Print(const std::string& text) {
  std::fputs(text.c_str(), stdout);
}

std::string ListProblems() {
  std::vector<std::vector<std::string>> rows;
  for (const ProblemEntry& entry : ProblemRegistry()) rows.push_back({entry.name, entry.says});
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

std::string ListParameters(const ProblemEntry& entry) {
  std::vector<std::vector<std::string>> rows{
      {"parameter", "unit", "lower", "upper", "start", "scale", "meaning", "source"}};
  for (const Parameter& p : entry.parameters()) {
    rows.push_back({p.name, p.unit, Readable(p.lower), Readable(p.upper), Readable(p.start),
                    p.scale == Scale::kLog ? "log" : "linear", p.meaning, p.source});
  }
  std::string text = Table(rows, 0) + "\nsinew data synthesize " + entry.name + " --set takes:\n";
  std::vector<std::vector<std::string>> settings;
  for (const auto& [name, says] : entry.experiment()) settings.push_back({name, says});
  return text + Table(settings, 2);
}

std::string ListEffects(const ProblemEntry& entry) {
  return "Every channel that " + entry.name +
         " is compared on has the effects of its sensor, shared by all trials\n" +
         Table({{"effect", "null", "says"},
                {"CHANNEL.offset", "0", "the sensor reads too much by a constant"},
                {"CHANNEL.drift", "0", "the sensor's reading drifts with time"},
                {"CHANNEL.gain", "1", "the sensor reads too much by a factor"},
                {"CHANNEL.time_offset", "0", "the sensor's clock is late against the other instruments"}},
               2) +
         "Release one with `sinew identify " + entry.name + " --release right_force_y.offset`.\n";
}

const std::vector<std::string> kSubjects{"problems", "solvers",    "formats",
                                         "effects",  "parameters", "channels"};

Result<int> List(const std::string& what, const std::string& problem) {
  if (std::find(kSubjects.begin(), kSubjects.end(), what) == kSubjects.end())
    return Fail("list: '{}' does not exist{}", what, Suggestion(what, kSubjects));
  if (what == "solvers") {
    Print(ListSolvers());
  } else if (what == "formats") {
    Print(ListFormats());
  } else if (what == "problems") {
    Print(ListProblems());
  } else {
    if (problem.empty())
      return Fail("list {}: expected a problem, such as `sinew list {} contact`", what, what);
    SINEW_ASSIGN(const ProblemEntry* entry, FindProblem(problem));
    if (what == "parameters") Print(ListParameters(*entry));
    if (what == "channels") Print(entry->channels);
    if (what == "effects") Print(ListEffects(*entry));
  }
  return kDone;
}

}  // namespace

void AddListCommand(CLI::App& app, const RunAction& run) {
  auto* command =
      app.add_subcommand("list", "What there is: problems, solvers, formats, and a problem's parts");
  auto what = std::make_shared<std::string>("problems");
  auto problem = std::make_shared<std::string>();
  command->add_option("what", *what, "One of " + Join(kSubjects, ", "))->capture_default_str();
  command->add_option("problem", *problem, "For effects, parameters and channels");
  command->callback([=] { run([=] { return List(*what, *problem); }); });
}

}  // namespace sinew
