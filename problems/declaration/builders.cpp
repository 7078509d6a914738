#include "problems/declaration/builders.h"

#include "problems/declaration/declared_problem.h"

namespace sinew {

template <class Change>
ParameterBuilder& ParameterBuilder::Apply(Change change) {
  for (std::size_t trial = 0; trial < problem_->trials().size(); ++trial)
    change(problem_->ParameterOf(slot_, trial));
  return *this;
}

ParameterBuilder& ParameterBuilder::bounds(double lower, double upper) {
  problem_->MarkBounded(slot_);
  return Apply([&](Parameter& p) {
    p.lower = lower;
    p.upper = upper;
  });
}

ParameterBuilder& ParameterBuilder::start(double value) {
  problem_->MarkStarted(slot_);
  return Apply([&](Parameter& p) { p.start = value; });
}

ParameterBuilder& ParameterBuilder::log() {
  return Apply([](Parameter& p) { p.scale = Scale::kLog; });
}

ParameterBuilder& ParameterBuilder::meaning(std::string text) {
  return Apply([&](Parameter& p) { p.meaning = text; });
}

ParameterBuilder& ParameterBuilder::source(std::string text) {
  return Apply([&](Parameter& p) { p.source = text; });
}

ParameterBuilder& ParameterBuilder::prior(double mean, double deviation) {
  return Apply([&](Parameter& p) { p.prior = GaussianPrior{mean, deviation}; });
}

ParameterBuilder& ParameterBuilder::null(double value) {
  return Apply([&](Parameter& p) {
    p.null_value = value;
    p.start = value;
  });
}

ParameterBuilder& ParameterBuilder::probes(std::vector<double> values) {
  return Apply([&](Parameter& p) {
    // A value that means nothing at the null rests in the middle of those that are tried.
    if (!values.empty() && p.null_value == 0) p.start = p.null_value = values[values.size() / 2];
    p.probes = values;
  });
}

ParameterBuilder& ParameterBuilder::null_step(double step) {
  return Apply([&](Parameter& p) { p.null_step = step; });
}

EffectBuilder& EffectBuilder::description(std::string text) {
  problem_->effects_[static_cast<std::size_t>(effect_)].description = std::move(text);
  return *this;
}

EffectBuilder& EffectBuilder::revealing_experiment(std::string text) {
  problem_->effects_[static_cast<std::size_t>(effect_)].revealing_experiment = std::move(text);
  return *this;
}

EffectBuilder& EffectBuilder::occurrence(Occurrence occurrence) {
  problem_->effects_[static_cast<std::size_t>(effect_)].occurrence = occurrence;
  return *this;
}

ParameterBuilder EffectBuilder::parameter(const std::string& name, const std::string& unit) {
  return problem_->AddEffectParameter(effect_, name, unit);
}

}  // namespace sinew
