#include "identify/diagnosis/score/candidate.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "identify/probe_grid.h"

namespace sinew::diagnosis {
namespace {

std::vector<Candidate::Probe> ProbesOf(const std::vector<Parameter>& parameters,
                                       const std::vector<int>& group) {
  std::vector<Candidate::Probe> probes;
  for (ProbeValues& values : ProbeGrid(parameters, group)) probes.push_back({std::move(values)});
  return probes;
}

bool AnyFree(const FitSetup& base, const std::vector<int>& group) {
  return std::any_of(group.begin(), group.end(), [&](int index) { return base.IsFree(index); });
}

std::vector<int> NotHeld(const FitSetup& base, const std::vector<int>& group) {
  std::vector<int> rest;
  std::copy_if(group.begin(), group.end(), std::back_inserter(rest),
               [&](int index) { return !base.IsHeld(index); });
  return rest;
}

}  // namespace

std::vector<Candidate> ListCandidates(const Problem& problem, const FitSetup& base) {
  std::vector<Candidate> candidates;
  for (const Effect& effect : problem.effects()) {
    const std::vector<int> parameters = NotHeld(base, effect.parameters);
    if (AnyFree(base, effect.parameters) || (parameters.empty() && !effect.parameters.empty())) continue;
    candidates.push_back({effect.name, effect.level, true, effect.description, effect.revealing_experiment,
                          effect.occurrence, effect.trial, parameters,
                          ProbesOf(base.parameters, parameters)});
  }
  for (const DiscrepancyPort& port : problem.ports()) {
    for (const DiscrepancyTerm& term : port.terms) {
      const bool whole = NotHeld(base, term.parameters).size() == term.parameters.size();
      if (AnyFree(base, term.parameters) || !whole) continue;
      candidates.push_back(
          {term.name, Level::kRobot, false, "", "", Occurrence::kOccasional, "", term.parameters, {{}}});
      candidates.back().beside_causes = term.beside_causes;
    }
  }
  // Drifts: of parameters that are free, or would be free with a candidate effect.
  for (std::size_t i = 0; i < base.parameters.size(); ++i) {
    const Parameter& p = base.parameters[i];
    const auto index = static_cast<int>(i);
    const bool of_effect = std::any_of(candidates.begin(), candidates.end(), [&](const Candidate& c) {
      return c.primary() && std::count(c.parameters.begin(), c.parameters.end(), index) > 0 &&
             p.probes.empty();
    });
    if (!of_effect && !(p.kind == ParameterKind::kBase && base.IsFree(index))) continue;
    Candidate drift;
    drift.effect = p.name + "(time)";
    drift.level = Level::kRobot;
    drift.known = false;
    drift.probes = {{}};
    drift.drifting = index;
    candidates.push_back(std::move(drift));
  }
  return candidates;
}

Vector TimeInTrial(const Block& block) {
  const double begin = block.prediction_time.front();
  const double half = 0.5 * (block.prediction_time.back() - begin);
  Vector time(block.samples());
  for (int i = 0; i < block.samples(); ++i) {
    const double t =
        block.prediction_time[static_cast<std::size_t>(block.sample[static_cast<std::size_t>(i)])];
    time[i] = half > 0 ? (t - begin) / half - 1 : 0;
  }
  return time;
}

std::vector<int> ScoredParameters(const Candidate& candidate, std::size_t probe) {
  if (IsScoredBySecant(candidate, probe)) return {candidate.probes[probe].at.front().first};
  std::vector<int> scored;
  for (const int index : candidate.parameters) {
    const auto& at = candidate.probes[probe].at;
    const bool stands = std::any_of(at.begin(), at.end(), [&](const auto& p) { return p.first == index; });
    if (!stands) scored.push_back(index);
  }
  return scored;
}

bool IsScoredBySecant(const Candidate& candidate, std::size_t probe) {
  return !candidate.parameters.empty() && candidate.probes[probe].at.size() == candidate.parameters.size();
}

}  // namespace sinew::diagnosis
