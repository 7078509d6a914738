#include "cli/list_json.h"

#include "cli/data/dataset_json.h"
#include "identify/solvers/solver.h"
#include "models/mechanisms/integrator.h"

namespace sinew {
namespace {

using Json = nlohmann::ordered_json;

}  // namespace

std::string ProblemsJson(const std::vector<ProblemEntry>& problems) {
  Json json{{"problems", Json::array()}};
  for (const ProblemEntry& entry : problems)
    json["problems"].push_back({{"name", entry.name}, {"description", entry.description}});
  return ToText(json);
}

std::string SolversJson() {
  Json json{{"solvers", Json::array()}};
  for (const SolverEntry& entry : SolverRegistry()) {
    json["solvers"].push_back({{"name", entry.name},
                               {"global", entry.global},
                               {"jacobian", entry.gradient},
                               {"constraints", entry.constraints},
                               {"description", entry.description}});
  }
  return ToText(json);
}

std::string IntegratorsJson() {
  Json json{{"integrators", Json::array()}};
  for (const IntegratorEntry& entry : IntegratorRegistry())
    json["integrators"].push_back({{"name", entry.name}, {"description", entry.description}});
  return ToText(json);
}

std::string FormatsJson(const std::vector<FormatEntry>& formats) {
  Json json{{"formats", Json::array()}};
  for (const FormatEntry& format : formats) {
    json["formats"].push_back(
        {{"name", format.name}, {"read", format.read}, {"written", format.written}, {"holds", format.holds}});
  }
  return ToText(json);
}

std::string ParametersJson(const ProblemEntry& entry) {
  return ParametersJson(entry, entry.parameters());
}

std::string ParametersJson(const ProblemEntry& entry, const std::vector<Parameter>& parameters) {
  Json json{{"problem", entry.name}, {"parameters", Json::array()}, {"experiment", Json::array()}};
  for (const Parameter& p : parameters) {
    json["parameters"].push_back({{"name", p.name},
                                  {"unit", p.unit},
                                  {"lower", p.lower},
                                  {"upper", p.upper},
                                  {"start", p.start},
                                  {"scale", p.scale == Scale::kLog ? "log" : "linear"},
                                  {"meaning", p.meaning},
                                  {"source", p.source}});
  }
  const auto experiment = entry.experiment == nullptr ? decltype(entry.experiment()){} : entry.experiment();
  for (const auto& [name, description] : experiment)
    json["experiment"].push_back({{"name", name}, {"description", description}});
  return ToText(json);
}

std::string EffectsJson(const ProblemEntry& entry, const Problem& problem) {
  Json json{{"problem", entry.name}, {"effects", Json::array()}, {"discrepancy_terms", Json::array()}};
  for (const Effect& effect : problem.effects()) {
    Json parameters = Json::array();
    for (const int index : effect.parameters) {
      const Parameter& p = problem.parameters()[static_cast<std::size_t>(index)];
      parameters.push_back({{"name", p.name}, {"unit", p.unit}, {"null", p.null_value}});
    }
    json["effects"].push_back({{"name", effect.name},
                               {"level", ToString(effect.level)},
                               {"trial", effect.trial},
                               {"description", effect.description},
                               {"revealing_experiment", effect.revealing_experiment},
                               {"parameters", parameters}});
  }
  for (const DiscrepancyPort& port : problem.ports()) {
    for (const DiscrepancyTerm& term : port.terms) json["discrepancy_terms"].push_back(term.name);
  }
  return ToText(json);
}

std::string BlocksJson(const ProblemEntry& entry, const Problem& problem) {
  Json json{{"problem", entry.name}, {"blocks", Json::array()}};
  for (const Block& block : problem.layout()) {
    json["blocks"].push_back({{"trial", block.trial},
                              {"channel", block.channel},
                              {"unit", block.unit},
                              {"role", ToString(block.role)},
                              {"samples", block.samples()}});
  }
  return ToText(json);
}

std::string ChannelsJson(const ProblemEntry& entry) {
  return ToText({{"problem", entry.name}, {"description", entry.channels}});
}

}  // namespace sinew
