#include "identify/files/json_values.h"
#include "identify/files/run_file.h"
#include "identify/text/findings.h"
#include "identify/text/reasons.h"
#include "identify/text/warnings.h"

namespace sinew::files {
namespace {

// What would help, the best first: additions that together suffice, and the standard error that they bring.
Json FromOptions(const std::vector<RemedyOption>& options) {
  Json json = Json::array();
  for (const RemedyOption& option : options) {
    Json additions = Json::array();
    for (const AdditionName& addition : option.additions)
      additions.push_back({{"kind", ToString(addition.kind)}, {"name", addition.name}});
    json.push_back({{"additions", additions}, {"std_error", Finite(option.std_error)}});
  }
  return json;
}

Json FromDirection(const OpenDirection& direction) {
  Json changes = Json::array();
  for (const ParameterChange& part : direction.changes) {
    changes.push_back({{"parameter", part.parameter},
                       {"unit", part.unit},
                       {"change", Finite(part.change)},
                       {"relative", Finite(part.relative)}});
  }
  return {{"lost", direction.lost}, {"changes", changes}};
}

Json FromQualities(const std::vector<FitQuality>& qualities) {
  Json json = Json::array();
  for (const FitQuality& q : qualities) {
    json.push_back({{"trial", q.trial},
                    {"role", ToString(q.role)},
                    {"channel", q.channel},
                    {"unit", q.unit},
                    {"rmse", Finite(q.rmse)},
                    {"mae", Finite(q.mae)},
                    {"r2", Finite(q.r2)},
                    {"n", q.n}});
  }
  return json;
}

Json FromRun(const Problem& problem, const Identification& identification, const Provenance& provenance) {
  Json json = ResultHead("sinew.run/1", provenance);
  json["solver"] = identification.solver;
  json["seed"] = identification.solver_options.seed;
  json["stop_reason"] = ToString(identification.result.stop.kind);
  json["stop_test"] = identification.result.stop.test;
  json["converged"] = identification.result.stop.converged();
  json["evaluations"] = identification.record.evaluations();
  json["seconds"] = identification.seconds;
  json["cost"] = Finite(identification.result.cost);
  json["objective"] = problem.objective();
  json["figures"] = Json::array();
  for (const FigureOfMerit& figure : identification.figures)
    json["figures"].push_back(
        {{"name", figure.name}, {"value", Finite(figure.value)}, {"meaning", text::Meaning(figure)}});
  json["derived"] = Json::array();
  for (const DerivedResult& one : identification.derived) {
    json["derived"].push_back(
        {{"name", one.name},
         {"value", Finite(one.value)},
         {"unit", one.unit},
         {"ci95", one.interval ? Json{Finite(one.ci95_lower), Finite(one.ci95_upper)} : Json(nullptr)},
         {"from", one.from},
         {"meaning", one.meaning}});
  }
  json["parameters"] = Json::array();
  for (const ParameterVerdict& v : identification.uncertainty.parameters) {
    const Parameter& p = identification.setup.parameters[static_cast<std::size_t>(v.parameter)];
    const bool interval = v.interval != IntervalKind::kNone;
    json["parameters"].push_back(
        {{"name", p.name},
         {"value", Finite(v.value)},
         {"unit", p.unit},
         {"shared_by", p.shared_by},
         {"lower", p.lower},
         {"upper", p.upper},
         {"std_error", Finite(v.std_error)},
         {"std_error_robust", Finite(v.std_error_robust)},
         {"ci95", interval ? Json{Finite(v.ci95_lower), Finite(v.ci95_upper)} : Json(nullptr)},
         {"verdict", ToString(v.verdict)},
         {"reason", text::ReasonText(p, v)},
         {"reason_kind", ToString(v.reason.kind)},
         {"reason_partners", v.reason.partners},
         {"reason_channels", v.reason.channels},
         {"remedy", text::RemedyText(p, v.remedy)},
         {"remedy_kind", ToString(v.remedy.kind)},
         {"remedies", FromOptions(v.remedy.options)}});
  }
  json["fit"] = FromQualities(identification.prediction.quality);
  json["alternatives"] = Json::array();
  for (const AlternativeQuality& alternative : identification.alternatives) {
    Json fit = FromQualities(alternative.quality);
    for (std::size_t i = 0; i < fit.size(); ++i) {
      const double half_width = alternative.half_width[i];
      fit[i]["band95_half_width"] = half_width > 0 ? Finite(half_width) : Json();
    }
    json["alternatives"].push_back({{"prediction", alternative.name}, {"fit", std::move(fit)}});
  }
  json["unmeasured"] = Json::array();
  for (const UnmeasuredChannel& channel : identification.unmeasured) {
    json["unmeasured"].push_back({{"trial", channel.trial},
                                  {"channel", channel.channel},
                                  {"unit", channel.unit},
                                  {"from", channel.from},
                                  {"lowest", Finite(channel.lowest)},
                                  {"highest", Finite(channel.highest)},
                                  {"band95_half_width", Finite(channel.mean_half_width)}});
  }
  json["open_directions"] = Json::array();
  for (const OpenDirection& direction : identification.uncertainty.directions)
    json["open_directions"].push_back(FromDirection(direction));
  const std::vector<text::Sentence> findings = text::Findings(identification);
  json["findings"] = text::TextsOf(findings);
  json["finding_facts"] = FromSentences(findings);
  json["warnings"] = text::Warnings(identification);
  json["warning_facts"] = FromWarnings(identification.warnings);
  return json;
}

}  // namespace
}  // namespace sinew::files

namespace sinew {

std::string RunJson(const Problem& problem, const Identification& identification,
                    const Provenance& provenance) {
  // Names of files and trials are bytes; what is not UTF-8 is replaced instead of thrown at.
  return files::FromRun(problem, identification, provenance)
      .dump(2, ' ', false, files::Json::error_handler_t::replace);
}

}  // namespace sinew
