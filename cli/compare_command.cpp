// sinew compare: solvers against each other on one problem, over several starts and seeds.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <nlohmann/json.hpp>

#include "base/numbers.h"
#include "base/random.h"
#include "base/text.h"
#include "base/version.h"
#include "cli/binding.h"
#include "cli/command.h"
#include "cli/terminal.h"
#include "identify/solvers/solver.h"

namespace sinew {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kTargetShare = 1.01;   // success: within 1 % of the best cost that any solver found
constexpr long kDefaultBudget = 20000;  // evaluations of a run; otherwise a global solver need not end

struct CompareWords {
  BindingOptions binding;
  FitOptions fit;
  std::vector<std::string> solvers;
  int repeats = 5;
  std::optional<double> target;
  std::string out;
  std::string json;
};

struct Run {
  std::string solver;
  std::uint64_t seed = 0;
  Stop stop;
  double cost = 0;
  double seconds = 0;
  std::vector<TraceEntry> trace;
  Vector parameters;

  // Evaluations and seconds until the cost first reached the target; NaN if it never did.
  [[nodiscard]] std::pair<double, double> ToTarget(double target) const {
    for (std::size_t i = 0; i < trace.size(); ++i) {
      if (trace[i].cost <= target) return {static_cast<double>(i + 1), trace[i].seconds};
    }
    return {kNaN, kNaN};
  }
};

// The first repeat starts where the problem says; all others at a random point of the box, the same for every
// solver.
Vector StartOf(const LeastSquares& problem, std::uint64_t seed, int repeat) {
  Vector start = problem.Start();
  if (repeat == 0) return start;
  Random random(Random::StreamSeed(seed, static_cast<std::uint64_t>(repeat)));
  for (double& x : start) x = random.Uniform();
  return start;
}

double Median(std::vector<double> values) {
  values.erase(std::remove_if(values.begin(), values.end(), [](double v) { return std::isnan(v); }),
               values.end());
  if (values.empty()) return kNaN;
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  return n % 2 == 1 ? values[n / 2] : 0.5 * (values[n / 2 - 1] + values[n / 2]);
}

struct Study {
  std::vector<Run> runs;
  double best = std::numeric_limits<double>::infinity();
  double target = 0;
  std::vector<int> free;
};

Hdf5Node StudyTree(const Study& study, const Binding& binding, const CompareWords& words) {
  Hdf5Node root;
  Hdf5Node& node = root.At("study");
  node.attributes["sinew_schema"] = std::string("study/1");
  node.attributes["problem"] = words.binding.problem;
  node.attributes["data_file"] = words.binding.data;
  node.attributes["title"] = binding.data.title;
  node.attributes["synthetic"] = std::int64_t{binding.data.synthetic ? 1 : 0};
  node.attributes["version"] = std::string(kVersion);
  node.attributes["objective"] = binding.problem().objective();
  node.attributes["target"] = study.target;
  node.attributes["best_cost"] = study.best;
  std::vector<std::string> solver, stop, names, units;
  std::vector<double> seed, cost, success, evaluations, to_target, seconds, seconds_to_target, values, lower,
      upper;
  for (const int index : study.free) {
    const Parameter& p = binding.problem().parameters()[static_cast<std::size_t>(index)];
    names.push_back(p.name);
    units.push_back(p.unit);
    lower.push_back(p.lower);
    upper.push_back(p.upper);
  }
  for (const Run& run : study.runs) {
    const auto [n, s] = run.ToTarget(study.target);
    solver.push_back(run.solver);
    stop.emplace_back(ToString(run.stop.kind));
    seed.push_back(static_cast<double>(run.seed));
    cost.push_back(run.cost);
    success.push_back(run.cost <= study.target ? 1 : 0);
    evaluations.push_back(static_cast<double>(run.trace.size()));
    to_target.push_back(n);
    seconds.push_back(run.seconds);
    seconds_to_target.push_back(s);
    for (const int index : study.free)
      values.push_back(run.parameters.size() > 0 ? run.parameters[index] : kNaN);
  }
  Hdf5Node& parameters = node.At("parameters");
  parameters.At("name").data = names;
  parameters.At("unit").data = units;
  parameters.At("lower").SetVector(lower);
  parameters.At("upper").SetVector(upper);
  Hdf5Node& runs = node.At("runs");
  runs.At("solver").data = solver;
  runs.At("stop_reason").data = stop;
  runs.At("seed").SetVector(seed);
  runs.At("cost").SetVector(cost);
  runs.At("success").SetVector(success);
  runs.At("evaluations").SetVector(evaluations);
  runs.At("evaluations_to_target").SetVector(to_target);
  runs.At("seconds").SetVector(seconds);
  runs.At("seconds_to_target").SetVector(seconds_to_target);
  runs.At("values").SetMatrix(study.runs.size(), names.size(), values);
  return root;
}

// One solver's runs, condensed.
struct Summary {
  std::string solver;
  int repeats = 0;
  int successes = 0;
  double cost_median = 0;
  double cost_worst = 0;
  double evaluations = 0;
  double evaluations_to_target = 0;
  double seconds = 0;
  double seconds_to_target = 0;
  std::vector<double> mean;       // of each free parameter
  std::vector<double> deviation;  // standard, over the repeats
};

Summary Summarise(const std::string& solver, const Study& study) {
  Summary summary;
  summary.solver = solver;
  std::vector<double> cost, evaluations, to_target, seconds, seconds_to_target;
  std::vector<std::vector<double>> values(study.free.size());
  for (const Run& run : study.runs) {
    if (run.solver != solver) continue;
    const auto [n, s] = run.ToTarget(study.target);
    ++summary.repeats;
    summary.successes += run.cost <= study.target ? 1 : 0;
    cost.push_back(run.cost);
    evaluations.push_back(static_cast<double>(run.trace.size()));
    to_target.push_back(n);
    seconds.push_back(run.seconds);
    seconds_to_target.push_back(s);
    for (std::size_t k = 0; k < study.free.size() && run.parameters.size() > 0; ++k)
      values[k].push_back(run.parameters[study.free[k]]);
  }
  summary.cost_median = Median(cost);
  summary.cost_worst = *std::max_element(cost.begin(), cost.end());
  summary.evaluations = Median(evaluations);
  summary.evaluations_to_target = Median(to_target);
  summary.seconds = Median(seconds);
  summary.seconds_to_target = Median(seconds_to_target);
  for (const auto& v : values) {
    double mean = 0;
    double squares = 0;
    for (const double value : v) mean += value / static_cast<double>(v.size());
    for (const double value : v) squares += (value - mean) * (value - mean);
    summary.mean.push_back(v.empty() ? kNaN : mean);
    summary.deviation.push_back(v.size() < 2 ? 0 : std::sqrt(squares / static_cast<double>(v.size() - 1)));
  }
  return summary;
}

std::string Number(double value) {
  return std::isnan(value) ? "-" : Readable(value);
}

std::string StudyTable(const Study& study, const Binding& binding, const std::vector<Summary>& summaries) {
  std::vector<std::vector<std::string>> rows{
      {"solver", "success", "cost (median)", "worst", "evaluations", "to target", "time", "to target"}};
  std::vector<std::vector<std::string>> spread{{"solver"}};
  for (const int index : study.free)
    spread[0].push_back(binding.problem().parameters()[static_cast<std::size_t>(index)].name);
  for (const Summary& s : summaries) {
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

std::string StudyJson(const Study& study, const Binding& binding, const CompareWords& words,
                      const std::vector<Summary>& summaries) {
  using Json = nlohmann::ordered_json;
  const auto finite = [](double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); };
  Json json{{"schema", "sinew.study/1"},      {"problem", words.binding.problem},
            {"data", words.binding.data},     {"best_cost", finite(study.best)},
            {"target", finite(study.target)}, {"solvers", Json::array()}};
  for (const Summary& s : summaries) {
    Json parameters = Json::array();
    for (std::size_t k = 0; k < s.mean.size(); ++k) {
      parameters.push_back(
          {{"name", binding.problem().parameters()[static_cast<std::size_t>(study.free[k])].name},
           {"mean", finite(s.mean[k])},
           {"standard_deviation", finite(s.deviation[k])}});
    }
    json["solvers"].push_back({{"solver", s.solver},
                               {"repeats", s.repeats},
                               {"successes", s.successes},
                               {"cost_median", finite(s.cost_median)},
                               {"cost_worst", finite(s.cost_worst)},
                               {"evaluations", finite(s.evaluations)},
                               {"evaluations_to_target", finite(s.evaluations_to_target)},
                               {"seconds", finite(s.seconds)},
                               {"seconds_to_target", finite(s.seconds_to_target)},
                               {"parameters", parameters}});
  }
  return json.dump(2);
}

Result<int> RunCompare(const CompareWords& words) {
  SINEW_TRY(CheckOutput(words.out, {words.binding.data, words.binding.config}));
  SINEW_TRY(CheckOutput(words.json.empty() ? "-" : words.json, {words.binding.data, words.binding.config}));
  SINEW_ASSIGN(const Binding binding, Bind(words.binding, !words.fit.release.empty()));
  SINEW_ASSIGN(const FitRequest request, words.fit.Request());
  SINEW_ASSIGN(const FitSetup setup, MakeFitSetup(binding.problem(), request));
  for (const std::string& name : words.solvers) SINEW_TRY(MakeSolver(name, {}));
  const LeastSquares problem(binding.problem(), setup);

  Study study;
  study.free = setup.free;
  ProgressLine line("compare", words.fit.quiet);
  const int all = static_cast<int>(words.solvers.size()) * words.repeats;
  for (const std::string& name : words.solvers) {
    for (int repeat = 0; repeat < words.repeats && !InterruptFlag().load(); ++repeat) {
      SolverOptions options = words.fit.ToSolverOptions();
      options.seed = words.fit.seed + static_cast<std::uint64_t>(repeat);
      SINEW_ASSIGN(const auto solver, MakeSolver(name, options));
      Evaluator::Options evaluation;
      evaluation.budget = words.fit.ToBudget();
      if (!words.fit.max_evaluations && !words.fit.max_seconds)
        evaluation.budget.max_evaluations = kDefaultBudget;
      evaluation.interrupt = &InterruptFlag();
      Evaluator evaluator(problem, std::move(evaluation));
      const SolverResult result = solver->Solve(evaluator, StartOf(problem, words.fit.seed, repeat));
      Run run{name, options.seed, result.stop, result.cost, evaluator.seconds(), evaluator.trace(), {}};
      if (result.stop.usable()) {
        run.parameters = problem.Parameters(result.x);
        study.best = std::min(study.best, result.cost);
      }
      study.runs.push_back(std::move(run));
      line.Show(static_cast<int>(study.runs.size()), all);
    }
  }
  line.Clear();
  if (!std::isfinite(study.best)) {
    std::fprintf(stderr, "sinew: no usable answer: no solver found a point that can be predicted\n");
    return kNotUsable;
  }
  study.target = words.target.value_or(kTargetShare * study.best);
  SINEW_TRY(WriteHdf5(words.out, StudyTree(study, binding, words)));
  std::vector<Summary> summaries;
  for (const std::string& name : words.solvers) {
    const bool ran =
        std::any_of(study.runs.begin(), study.runs.end(), [&](const Run& run) { return run.solver == name; });
    if (ran) summaries.push_back(Summarise(name, study));
  }
  if (!words.json.empty()) SINEW_TRY(WriteText(words.json, StudyJson(study, binding, words, summaries)));
  if (words.json != "-") {
    std::printf("compare on %s of %s (%s): best cost %s, target %s\n", words.binding.problem.c_str(),
                words.binding.data.c_str(), binding.DescribeData().c_str(), Readable(study.best, 6).c_str(),
                Readable(study.target, 6).c_str());
    std::fputs(StudyTable(study, binding, summaries).c_str(), stdout);
    std::printf("Study file: %s\n", words.out.c_str());
  }
  return kDone;
}

}  // namespace

void AddCompareCommand(Command app, const RunAction& run) {
  auto words = std::make_shared<CompareWords>();
  Command command = app.AddCommand("compare", "Solvers against each other, over several starts and seeds");
  words->binding.AddTo(command);
  words->fit.AddTo(command);
  command.Add("--solvers", words->solvers, "Solvers and chains").Required().Split(',').Shows("A,B,C");
  command
      .Add("--repeats", words->repeats,
           "Runs per solver; the first starts where the problem says, the others at random")
      .Between(1, 100000)
      .ShowsDefault();
  command.Add("--target", words->target,
              "Cost that counts as success; default: within 1 % of the best found");
  command.Add("--out", words->out, "Study file to write").Required().Shows("STUDY.h5");
  command.Add("--json", words->json, "Result for machines; - for standard output").Shows("FILE|-");
  command.Runs(run, [=] { return RunCompare(*words); });
}

}  // namespace sinew
