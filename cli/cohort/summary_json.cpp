#include "cli/cohort/summary.h"
#include "identify/files/json_values.h"

namespace sinew::cohort {

using files::Finite;
using files::Json;

std::string SummaryJson(const Summary& summary) {
  const Pipeline& pipeline = *summary.pipeline;
  Json tasks = Json::array();
  for (std::size_t i = 0; i < pipeline.tasks.size(); ++i) {
    const TaskResult& result = summary.results[i];
    tasks.push_back({{"subject", pipeline.tasks[i].subject},
                     {"step", pipeline.tasks[i].step},
                     {"outcome", ToString(result.outcome)},
                     {"seconds", result.seconds},
                     {"reason", result.reason},
                     {"log", result.log},
                     {"written", pipeline.tasks[i].written}});
  }
  Json estimates = Json::array();
  for (const Estimate& one : summary.estimates)
    estimates.push_back({{"subject", one.subject},
                         {"step", one.step},
                         {"parameter", one.parameter},
                         {"unit", one.unit},
                         {"value", Finite(one.value)},
                         {"ci95", {Finite(one.lower), Finite(one.upper)}},
                         {"verdict", one.verdict}});
  Json spreads = Json::array();
  for (const ParameterSpread& one : summary.spreads)
    spreads.push_back({{"step", one.step},
                       {"parameter", one.parameter},
                       {"unit", one.unit},
                       {"subjects", one.subjects},
                       {"identifiable", one.identifiable},
                       {"median", Finite(one.median)},
                       {"lowest", Finite(one.lowest)},
                       {"highest", Finite(one.highest)}});
  Json diagnoses = Json::array();
  for (const SubjectDiagnosis& one : summary.diagnoses)
    diagnoses.push_back(
        {{"subject", one.subject}, {"step", one.step}, {"verdict", one.verdict}, {"causes", one.causes}});
  Json causes = Json::array();
  for (const Counted& one : summary.causes)
    causes.push_back({{"step", one.step}, {"effect", one.name}, {"subjects", one.subjects}});
  const Json json{{"schema", "sinew.cohort/1"}, {"subjects", pipeline.subjects},
                  {"steps", pipeline.steps},    {"tasks", tasks},
                  {"estimates", estimates},     {"spreads", spreads},
                  {"diagnoses", diagnoses},     {"causes", causes}};
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace sinew::cohort
