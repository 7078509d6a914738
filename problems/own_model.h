// A user's class as a problem of the program: bound to data, checked once, seen through its sensors.
#pragma once

#include <exception>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>

#include "base/error.h"
#include "base/text.h"
#include "base/yaml_reader.h"
#include "datasets/dataset.h"
#include "identify/check_problem.h"
#include "identify/observation/sensor_effects.h"
#include "identify/problem.h"
#include "problems/declaration/declared_problem.h"
#include "problems/registry.h"

namespace sinew {

/// Makes a P from data and checks it: its declaration, its layout, one prediction and its derivatives
/// (CheckProblem).
/// @tparam P a Problem that can be made from (const Dataset&), or from (const Dataset&, const YamlReader&) if
/// it has settings, or that has `static Result<std::unique_ptr<P>> Make(const Dataset&)`
/// @param with_sensor_effects every measured channel gets the effects of a sensor, see SensorEffects
/// Errors: what its constructor throws, and whatever breaks the contract of Problem.
template <class P>
Result<std::unique_ptr<Problem>> BindModel(const Dataset& data, bool with_sensor_effects = true,
                                           const YamlReader* settings = nullptr) {
  std::unique_ptr<P> model;
  try {
    if constexpr (std::is_constructible_v<P, const Dataset&, const YamlReader&>) {
      if (settings != nullptr) {
        model = std::make_unique<P>(data, *settings);
      } else {
        SINEW_ASSIGN(const YamlReader none, YamlReader::Parse("", "settings"));
        model = std::make_unique<P>(data, none);
      }
    } else if constexpr (std::is_constructible_v<P, const Dataset&>) {
      model = std::make_unique<P>(data);
    } else {
      SINEW_ASSIGN(model, P::Make(data));
    }
  } catch (const std::exception& exception) {
    return Fail("the model cannot be made from these data: {}", OneLine(exception.what()));
  }
  if constexpr (std::is_base_of_v<DeclaredProblem, P>) {
    SINEW_TRY(model->CheckDeclaration());
    SINEW_TRY(model->Prepare());
  }
  SINEW_TRY(CheckProblem(*model));
  if (!with_sensor_effects) return std::unique_ptr<Problem>(std::move(model));
  return std::unique_ptr<Problem>(std::make_unique<SensorEffects>(std::move(model)));
}

namespace own_model {

/// Errors: settings for a class that takes none.
template <class P>
Result<BoundProblem> Bind(const Dataset& data, const YamlReader& settings, bool with_sensor_effects) {
  constexpr bool kHasSettings = std::is_constructible_v<P, const Dataset&, const YamlReader&>;
  if constexpr (!kHasSettings) {
    SINEW_ASSIGN(const auto names, settings.Keys());
    for (const std::string& name : names) {
      SINEW_ASSIGN(const YamlReader section, settings.At(name));
      SINEW_TRY(section.OnlyKeys({}));
    }
  }
  BoundProblem bound;
  SINEW_ASSIGN(bound.problem, BindModel<P>(data, with_sensor_effects, &settings));
  return bound;
}

}  // namespace own_model

/// A user's class in a list of problems. @param description one line for `list problems`
/// It has no synthetic experiment: `data synthesize` is an error, and `list parameters` needs
/// data.
template <class P>
ProblemEntry ModelEntry(std::string name, std::string description = "a model of one's own") {
  ProblemEntry entry{};
  entry.name = std::move(name);
  entry.description = std::move(description);
  entry.bind = own_model::Bind<P>;
  entry.settings_optional = true;
  return entry;
}

}  // namespace sinew
