// How a model declares its parameters and effects: one sentence each.
//
//   area_ = parameter("outflow_area", "m2").bounds(1e-6, 1e-3).start(1e-4).log();
//   rate_ = effect("overflow", Level::kBoundary).description("water leaves over the rim")
//               .parameter("overflow_rate", "1/s").bounds(0, 10).null(0);
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "identify/effect.h"
#include "identify/parameter.h"
#include "problems/declaration/values.h"

namespace sinew {

class DeclaredProblem;

/// One parameter while it is declared, or the same of each trial. Valid while its problem is constructed.
class ParameterBuilder {
 public:
  ParameterBuilder(DeclaredProblem& problem, int slot) : problem_(&problem), slot_(slot) {}

  /// [unit] Must be stated. @pre lower < upper, finite
  ParameterBuilder& bounds(double lower, double upper);
  /// [unit] Where a search begins. Must be stated, except for effects, which begin at their null.
  ParameterBuilder& start(double value);
  /// Solvers step it by ratios. @pre lower bound > 0
  ParameterBuilder& log();
  /// One phrase for a person.
  ParameterBuilder& meaning(std::string text);
  /// Author, year, equation.
  ParameterBuilder& source(std::string text);
  /// What was known before. @param deviation [unit, > 0]; both of the logarithm if it is log()
  ParameterBuilder& prior(double mean, double deviation);
  /// Of an effect: the value at which it vanishes. Not stated: the middle one of its probes, else 0.
  ParameterBuilder& null(double value);
  /// Of an effect: values to try where nothing can be seen at the null.
  ParameterBuilder& probes(std::vector<double> values);
  /// Of an effect whose prediction has a kink at the null: how far to step for its slope, see
  /// Parameter::null_step.
  ParameterBuilder& null_step(double step);

  // NOLINTNEXTLINE(google-explicit-constructor): so that a declaration can be assigned to a handle
  operator ParameterHandle() const { return {slot_}; }

 private:
  template <class Change>
  ParameterBuilder& Apply(Change change);

  DeclaredProblem* problem_;
  int slot_;
};

/// One effect while it is declared.
class EffectBuilder {
 public:
  EffectBuilder(DeclaredProblem& problem, int effect) : problem_(&problem), effect_(effect) {}

  /// The cause as a sentence: "water leaves over the rim above some level".
  EffectBuilder& description(std::string text);
  /// The experiment that would show it.
  EffectBuilder& revealing_experiment(std::string text);
  /// How often it is found in practice: decides between causes that data do not distinguish. Default:
  /// kOccasional.
  EffectBuilder& occurrence(Occurrence occurrence);
  /// A parameter of this effect.
  ParameterBuilder parameter(const std::string& name, const std::string& unit);

 private:
  DeclaredProblem* problem_;
  int effect_;
};

}  // namespace sinew
