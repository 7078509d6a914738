#include "problems/kit/parameter_list.h"

#include <fmt/format.h>

#include <set>
#include <utility>

namespace sinew {

ParameterListBuilder::ParameterListBuilder(ParameterList& list, int slots) : list_(list) {
  list_.index.assign(static_cast<std::size_t>(slots), -1);
}

int ParameterListBuilder::Add(Parameter p, int slot) {
  const int index = static_cast<int>(list_.parameters.size());
  if (slot != kNoSlot) list_.index.at(static_cast<std::size_t>(slot)) = index;
  list_.parameters.push_back(std::move(p));
  return index;
}

ParameterListBuilder& ParameterListBuilder::BeginEffect(const std::string& name, Level level,
                                                        const std::string& description,
                                                        const std::string& revealing_experiment,
                                                        const std::string& source, const std::string& trial) {
  list_.effects.push_back({name, level, description, revealing_experiment, {}, trial});
  source_ = source;
  return *this;
}

ParameterListBuilder& ParameterListBuilder::Is(Occurrence occurrence) {
  list_.effects.back().occurrence = occurrence;
  return *this;
}

int ParameterListBuilder::AddNumber(const std::string& name, const std::string& unit,
                                    const std::string& meaning, double lower, double upper, double null,
                                    int slot) {
  Parameter p = BaseParameter(name, unit, meaning, lower, upper, null);
  p.source = source_;
  return AddNumber(std::move(p), slot);
}

int ParameterListBuilder::AddNumber(Parameter p, int slot) {
  Effect& effect = list_.effects.back();
  p.kind = ParameterKind::kEffect;
  p.effect = effect.name;
  p.trial = effect.trial;
  p.null_value = p.start;
  p.prior.reset();
  effect.parameters.push_back(Add(std::move(p), slot));
  return effect.parameters.back();
}

ParameterListBuilder& ParameterListBuilder::Number(int slot, const std::string& name, const std::string& unit,
                                                   const std::string& meaning, double lower, double upper,
                                                   double null) {
  AddNumber(name, unit, meaning, lower, upper, null, slot);
  return *this;
}

ParameterListBuilder& ParameterListBuilder::Positive(int slot, const std::string& name,
                                                     const std::string& unit, const std::string& meaning,
                                                     double upper) {
  return Number(slot, name, unit, meaning, 0, upper);
}

ParameterListBuilder& ParameterListBuilder::TwoSided(int slot, const std::string& name,
                                                     const std::string& unit, const std::string& meaning,
                                                     double reach) {
  return Number(slot, name, unit, meaning, -reach, reach);
}

void ParameterListBuilder::Probes(std::vector<double> probes) {
  list_.parameters.back().probes = std::move(probes);
}

void ParameterListBuilder::NullStep(double step) {
  list_.parameters.back().null_step = step;
}

void ParameterListBuilder::Copy(const Effect& effect, const std::vector<Parameter>& parameters, int slot) {
  list_.effects.push_back(effect);
  list_.effects.back().parameters = {
      Add(parameters[static_cast<std::size_t>(effect.parameters.front())], slot)};
}

void ParameterListBuilder::BeginPort(const std::string& name, const std::string& unit,
                                     const std::string& meaning) {
  list_.ports.push_back({name, unit, meaning, {}});
}

void ParameterListBuilder::BeginTerm(const std::string& signal, const std::string& signal_unit,
                                     std::vector<double> knots) {
  DiscrepancyPort& port = list_.ports.back();
  port.terms.push_back({port.name + "(" + signal + ")", signal, signal_unit, std::move(knots), {}});
}

int ParameterListBuilder::AddKnot(Parameter p, int slot) {
  DiscrepancyTerm& term = list_.ports.back().terms.back();
  p.kind = ParameterKind::kEffect;
  p.effect = term.name;
  p.null_value = p.start;
  term.parameters.push_back(Add(std::move(p), slot));
  return term.parameters.back();
}

void ParameterListBuilder::Term(const std::string& signal, const std::string& signal_unit,
                                const std::vector<double>& knots, double lower, double upper,
                                const std::string& meaning, int first_slot) {
  BeginTerm(signal, signal_unit, knots);
  const std::string unit = list_.ports.back().unit;
  const std::string name = list_.ports.back().terms.back().name;
  for (std::size_t k = 0; k < knots.size(); ++k) {
    AddKnot(BaseParameter(fmt::format("{}[{}]", name, k), unit,
                          fmt::format("{} where {} is knot {}", meaning, signal, k), lower, upper, 0),
            first_slot + static_cast<int>(k));
  }
}

Status CheckParameterList(const ParameterList& list) {
  SINEW_TRY(CheckParameters(list.parameters));
  std::set<std::string> names;
  std::set<int> owned;
  const auto own = [&](const std::string& name, const std::vector<int>& parameters) -> Status {
    if (parameters.empty()) return Fail("effect '{}' has no parameter", name);
    for (const int index : parameters) {
      if (index < 0 || index >= static_cast<int>(list.parameters.size()))
        return Fail("effect '{}': there is no parameter {}", name, index);
      const Parameter& p = list.parameters[static_cast<std::size_t>(index)];
      if (p.effect != name) return Fail("effect '{}': its parameter '{}' is of '{}'", name, p.name, p.effect);
      owned.insert(index);
    }
    return {};
  };
  for (const Effect& effect : list.effects) {
    if (effect.name.empty()) return Fail("an effect has no name");
    if (!names.insert(effect.name).second) return Fail("effect '{}' is declared twice", effect.name);
    SINEW_TRY(own(effect.name, effect.parameters));
  }
  for (const DiscrepancyPort& port : list.ports) {
    for (const DiscrepancyTerm& term : port.terms) SINEW_TRY(own(term.name, term.parameters));
  }
  for (std::size_t i = 0; i < list.parameters.size(); ++i) {
    const Parameter& p = list.parameters[i];
    if (p.kind == ParameterKind::kEffect && owned.count(static_cast<int>(i)) == 0)
      return Fail("parameter '{}' is of effect '{}', which does not list it", p.name, p.effect);
  }
  return {};
}

}  // namespace sinew
