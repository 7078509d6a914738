#include "identify/files/study_file.h"

#include "base/version.h"
#include "identify/files/json_values.h"

namespace sinew::files {
namespace {

constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();

const Parameter& ParameterAt(const Problem& problem, int index) {
  return problem.parameters()[static_cast<std::size_t>(index)];
}

void WriteFreeParameters(const Problem& problem, const Study& study, Hdf5Node& node) {
  std::vector<std::string> names, units;
  std::vector<double> lower, upper;
  for (const int index : study.free) {
    const Parameter& p = ParameterAt(problem, index);
    names.push_back(p.name);
    units.push_back(p.unit);
    lower.push_back(p.lower);
    upper.push_back(p.upper);
  }
  node.At("name").data = names;
  node.At("unit").data = units;
  node.At("lower").SetVector(lower);
  node.At("upper").SetVector(upper);
}

void WriteRuns(const Study& study, Hdf5Node& node) {
  std::vector<std::string> solver, stop, test;
  std::vector<double> seed, cost, success, evaluations, to_target, seconds, seconds_to_target, values;
  for (const StudyRun& run : study.runs) {
    const StudyRun::Effort effort = run.ToTarget(study.target);
    solver.push_back(run.solver);
    stop.emplace_back(ToString(run.stop.kind));
    test.push_back(run.stop.test);
    seed.push_back(static_cast<double>(run.seed));
    cost.push_back(run.cost);
    success.push_back(run.cost <= study.target ? 1 : 0);
    evaluations.push_back(static_cast<double>(run.evaluations));
    to_target.push_back(effort.evaluations);
    seconds.push_back(run.seconds);
    seconds_to_target.push_back(effort.seconds);
    for (const int index : study.free)
      values.push_back(run.parameters.size() > 0 ? run.parameters[index] : kMissing);
  }
  node.At("solver").data = solver;
  node.At("stop_reason").data = stop;
  node.At("stop_test").data = test;
  node.At("seed").SetVector(seed);
  node.At("cost").SetVector(cost);
  node.At("success").SetVector(success);
  node.At("evaluations").SetVector(evaluations);
  node.At("evaluations_to_target").SetVector(to_target);
  node.At("seconds").SetVector(seconds);
  node.At("seconds_to_target").SetVector(seconds_to_target);
  node.At("values").SetMatrix(study.runs.size(), study.free.size(), values);
}

void WriteImprovements(const Study& study, Hdf5Node& node) {
  std::vector<double> of_run, evaluation, cost, seconds;
  for (std::size_t r = 0; r < study.runs.size(); ++r) {
    for (const StudyRun::Improvement& better : study.runs[r].improvements) {
      of_run.push_back(static_cast<double>(r));
      evaluation.push_back(static_cast<double>(better.evaluation));
      cost.push_back(better.cost);
      seconds.push_back(better.seconds);
    }
  }
  node.At("run").SetVector(std::move(of_run));
  node.At("evaluation").SetVector(std::move(evaluation));
  node.At("cost").SetVector(std::move(cost));
  node.At("seconds").SetVector(std::move(seconds));
}

}  // namespace

Hdf5Node StudyTree(const Problem& problem, const Study& study, const Provenance& provenance,
                   const Hdf5Node& origin) {
  Hdf5Node root;
  Hdf5Node& node = root.At("study");
  node.attributes["sinew_schema"] = std::string("study/1");
  node.attributes["problem"] = provenance.problem;
  node.attributes["data_file"] = provenance.data_file;
  node.attributes["title"] = provenance.title;
  node.attributes["synthetic"] = std::int64_t{provenance.synthetic ? 1 : 0};
  node.attributes["version"] = std::string(kVersion);
  node.attributes["objective"] = problem.objective();
  node.attributes["finished"] = std::int64_t{study.finished ? 1 : 0};
  node.attributes["target"] = study.target;
  node.attributes["best_cost"] = study.best;
  WriteFreeParameters(problem, study, node.At("parameters"));
  WriteRuns(study, node.At("runs"));
  WriteImprovements(study, node.At("improvements"));
  node.At("origin") = origin;
  return root;
}

std::string StudyJson(const Problem& problem, const Study& study, const Provenance& provenance) {
  Json json = ResultHead("sinew.study/1", provenance);
  json["finished"] = study.finished;
  json["best_cost"] = Finite(study.best);
  json["target"] = Finite(study.target);
  json["solvers"] = Json::array();
  for (const SolverSummary& s : Summarise(study)) {
    Json parameters = Json::array();
    for (std::size_t k = 0; k < s.mean.size(); ++k) {
      parameters.push_back({{"name", ParameterAt(problem, study.free[k]).name},
                            {"mean", Finite(s.mean[k])},
                            {"standard_deviation", Finite(s.deviation[k])}});
    }
    json["solvers"].push_back({{"solver", s.solver},
                               {"repeats", s.repeats},
                               {"successes", s.successes},
                               {"cost_median", Finite(s.cost_median)},
                               {"cost_worst", Finite(s.cost_worst)},
                               {"evaluations", Finite(s.evaluations)},
                               {"evaluations_to_target", Finite(s.evaluations_to_target)},
                               {"seconds", Finite(s.seconds)},
                               {"seconds_to_target", Finite(s.seconds_to_target)},
                               {"parameters", parameters}});
  }
  return json.dump(2, ' ', false, Json::error_handler_t::replace);
}

}  // namespace sinew::files
