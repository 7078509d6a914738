#include "problems/emg_shape/parameter_list.h"

#include <cmath>
#include <utility>

namespace sinew {
namespace {

constexpr const char* kParameterSource = "thesis ch. 6; docs/decisions/emg_shape_model.md";

}  // namespace

double EmgParameterList::LogSpeed(const EmgShapeTrial& trial) const {
  return std::log(trial.speed / data.reference.speed);
}

double EmgParameterList::Rhythm(const EmgShapeTrial& trial) const {
  return 1 / trial.period - 1 / data.reference.period;
}

int EmgParameterList::Add(Parameter p) {
  p.source = kParameterSource;
  return list.Add(std::move(p));
}

int EmgParameterList::AddNumber(Parameter p) {
  p.source = kParameterSource;
  return list.AddNumber(std::move(p));
}

int EmgParameterList::AddKnot(Parameter p) {
  p.source = kParameterSource;
  return list.AddKnot(std::move(p));
}

int EmgParameterList::AddNuisance(Parameter p, double deviation) {
  p.kind = ParameterKind::kNuisance;
  if (deviation > 0) p.prior = GaussianPrior{p.start, deviation};
  return Add(std::move(p));
}

void EmgParameterList::Touch(std::size_t trial, std::size_t muscle, EmgColumn column) {
  const auto block = static_cast<std::size_t>(data.trials[trial].first_block) + muscle;
  made.columns[block].push_back(column);
}

}  // namespace sinew
