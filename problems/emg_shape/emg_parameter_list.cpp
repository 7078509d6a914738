#include "problems/emg_shape/emg_parameter_list.h"

#include <cmath>
#include <utility>

namespace sinew {

double EmgParameterList::LogSpeed(const EmgShapeTrial& trial) const {
  return std::log(trial.speed / data.reference.speed);
}

double EmgParameterList::Rhythm(const EmgShapeTrial& trial) const {
  return 1 / trial.period - 1 / data.reference.period;
}

void EmgParameterList::Name(const std::string& name, Level level, const std::string& description,
                            const std::string& revealing_experiment) {
  made.effects.push_back({name, level, description, revealing_experiment, {}});
}

int EmgParameterList::Add(Parameter p, const std::string& effect) {
  p.source = "thesis ch. 6; docs/decisions/emg_shape_model.md";
  const int index = static_cast<int>(made.parameters.size());
  if (!effect.empty()) {
    p.kind = ParameterKind::kEffect;
    p.effect = effect;
    p.null_value = p.start;
    p.prior.reset();
    if (!made.effects.empty() && made.effects.back().name == effect)
      made.effects.back().parameters.push_back(index);
  }
  made.parameters.push_back(std::move(p));
  return index;
}

int EmgParameterList::AddNuisance(Parameter p, double deviation) {
  p.kind = ParameterKind::kNuisance;
  if (deviation > 0) p.prior = GaussianPrior{p.start, deviation};
  return Add(std::move(p), "");
}

void EmgParameterList::Touch(std::size_t trial, std::size_t muscle, EmgColumn column) {
  const auto block = static_cast<std::size_t>(data.trials[trial].first_block) + muscle;
  made.columns[block].push_back(column);
}

}  // namespace sinew
