#include "identify/files/json_values.h"
#include "identify/files/run_file.h"

namespace sinew {

std::string RunJson(const Problem& problem, const Identification& identification,
                    const Provenance& provenance) {
  Json json = ResultHead("sinew.run/1", provenance);
  json["solver"] = identification.solver;
  json["seed"] = identification.solver_options.seed;
  json["stop_reason"] = ToString(identification.result.stop.kind);
  json["stop_test"] = identification.result.stop.test;
  json["converged"] = identification.result.stop.converged();
  json["evaluations"] = identification.trace.size();
  json["seconds"] = identification.seconds;
  json["cost"] = Finite(identification.result.cost);
  json["objective"] = problem.objective();
  json["parameters"] = Json::array();
  for (const ParameterVerdict& v : identification.uncertainty.parameters) {
    const Parameter& p = identification.setup.parameters[static_cast<std::size_t>(v.parameter)];
    const bool interval = v.interval != IntervalKind::kNone;
    json["parameters"].push_back(
        {{"name", p.name},
         {"value", Finite(v.value)},
         {"unit", p.unit},
         {"lower", p.lower},
         {"upper", p.upper},
         {"std_error", Finite(v.std_error)},
         {"std_error_robust", Finite(v.std_error_robust)},
         {"ci95", interval ? Json{Finite(v.ci95_lower), Finite(v.ci95_upper)} : Json(nullptr)},
         {"verdict", ToString(v.verdict)},
         {"reason", v.reason},
         {"remedy", v.remedy}});
  }
  json["fit"] = Json::array();
  for (const FitQuality& q : identification.prediction.quality) {
    json["fit"].push_back({{"trial", q.trial},
                           {"role", ToString(q.role)},
                           {"channel", q.channel},
                           {"unit", q.unit},
                           {"rmse", Finite(q.rmse)},
                           {"mae", Finite(q.mae)},
                           {"r2", Finite(q.r2)},
                           {"n", q.n}});
  }
  json["findings"] = identification.findings;
  json["warnings"] = identification.warnings;
  // Names of files and trials are bytes; what is not UTF-8 is replaced instead of thrown at.
  return json.dump(2, ' ', false, Json::error_handler_t::replace);
}

}  // namespace sinew
