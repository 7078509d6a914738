#include "identify/fit_setup.h"

#include <algorithm>
#include <set>

#include "base/text.h"
#include "identify/check_problem.h"

namespace sinew {
namespace {

// The parameters of an effect or of an unknown term.
Result<std::vector<int>> ParametersOf(const Problem& problem, const std::string& name) {
  std::vector<std::string> names;
  for (const Effect& effect : problem.effects()) {
    if (effect.name == name) return effect.parameters;
    names.push_back(effect.name);
  }
  for (const DiscrepancyPort& port : problem.ports()) {
    for (const DiscrepancyTerm& term : port.terms) {
      if (term.name == name) return term.parameters;
      names.push_back(term.name);
    }
  }
  if (names.empty()) return Fail("effect '{}' does not exist: this problem declares none", name);
  return Fail("effect '{}' does not exist{}", name, Suggestion(name, names));
}

// Nuisance parameters of held-out trials are not part of the fit; FitHeldOutNuisance estimates them
// afterwards.
bool BelongsToHeldOutTrial(const Problem& problem, const Parameter& p) {
  if (p.trial.empty()) return false;
  const Layout& layout = problem.layout();
  return std::none_of(layout.begin(), layout.end(), [&](const Block& block) {
    return block.trial == p.trial && block.role == BlockRole::kTrain;
  });
}

}  // namespace

bool FitSetup::IsFree(int parameter) const {
  return std::binary_search(free.begin(), free.end(), parameter);
}

bool FitSetup::HasNuisancePriors() const {
  return std::any_of(free.begin(), free.end(), [&](int index) {
    const Parameter& p = parameters[static_cast<std::size_t>(index)];
    return p.kind == ParameterKind::kNuisance && p.prior.has_value();
  });
}

bool FitSetup::IsHeld(int parameter) const {
  return std::binary_search(held.begin(), held.end(), parameter);
}

Result<FitSetup> MakeFitSetup(const Problem& problem, const FitRequest& request) {
  SINEW_TRY(CheckEffects(problem));
  FitSetup setup;
  setup.parameters = problem.parameters();
  std::set<int> free;
  std::set<int> held;
  for (std::size_t i = 0; i < setup.parameters.size(); ++i) {
    const Parameter& p = setup.parameters[i];
    const bool listed = request.free.empty() ? p.kind == ParameterKind::kBase : false;
    const bool nuisance = p.kind == ParameterKind::kNuisance && !BelongsToHeldOutTrial(problem, p);
    if (listed || nuisance) free.insert(static_cast<int>(i));
  }
  for (const std::string& name : request.free) {
    SINEW_ASSIGN(const int index, FindParameter(setup.parameters, name));
    if (setup.parameters[static_cast<std::size_t>(index)].kind == ParameterKind::kPrior)
      return Fail("parameter '{}' belongs to a prior: it is chosen before the search, or held by --fix",
                  name);
    free.insert(index);
  }
  std::vector<int> flat_at_null;  // of effects whose parameters all have probe values: no slope at the null
  for (const std::string& name : request.release) {
    SINEW_ASSIGN(const std::vector<int> parameters, ParametersOf(problem, name));
    free.insert(parameters.begin(), parameters.end());
    const bool flat = std::none_of(parameters.begin(), parameters.end(), [&](int index) {
      return setup.parameters[static_cast<std::size_t>(index)].probes.empty();
    });
    if (flat) flat_at_null.insert(flat_at_null.end(), parameters.begin(), parameters.end());
  }

  for (const auto& [name, interval] : request.bounds) {
    SINEW_ASSIGN(const int index, FindParameter(setup.parameters, name));
    Parameter& p = setup.parameters[static_cast<std::size_t>(index)];
    p.lower = interval.first;
    p.upper = interval.second;
    const auto outside = [&](double start) { return start < p.lower || start > p.upper; };
    p.other_starts.erase(std::remove_if(p.other_starts.begin(), p.other_starts.end(), outside),
                         p.other_starts.end());
  }
  for (const int index : flat_at_null) {
    Parameter& p = setup.parameters[static_cast<std::size_t>(index)];
    if (p.start != p.null_value) continue;
    const double probe = p.probes[p.probes.size() / 2];
    if (probe >= p.lower && probe <= p.upper) p.start = probe;
  }
  for (const auto& [name, value] : request.start) {
    SINEW_ASSIGN(const int index, FindParameter(setup.parameters, name));
    setup.parameters[static_cast<std::size_t>(index)].start = value;
    setup.stated_starts.push_back(index);
  }
  for (const auto& [name, value] : request.fix) {
    SINEW_ASSIGN(const int index, FindParameter(setup.parameters, name));
    if (std::find(request.free.begin(), request.free.end(), name) != request.free.end()) {
      return Fail("parameter '{}' is asked to be both free and fixed", name);
    }
    Parameter& p = setup.parameters[static_cast<std::size_t>(index)];
    if (!(value >= p.lower && value <= p.upper)) {
      return Fail("parameter '{}': fixed at {}, outside its bounds {} .. {} [{}]", name, value, p.lower,
                  p.upper, p.unit);
    }
    p.start = value;
    free.erase(index);
    held.insert(index);
  }
  SINEW_TRY(CheckParameters(setup.parameters));

  setup.free.assign(free.begin(), free.end());
  setup.held.assign(held.begin(), held.end());
  setup.rest.resize(static_cast<Eigen::Index>(setup.parameters.size()));
  for (std::size_t i = 0; i < setup.parameters.size(); ++i) {
    const Parameter& p = setup.parameters[i];
    const bool starts = setup.IsFree(static_cast<int>(i)) || setup.IsHeld(static_cast<int>(i));
    setup.rest[static_cast<Eigen::Index>(i)] = starts ? p.start : p.rest_value();
  }
  return setup;
}

}  // namespace sinew
