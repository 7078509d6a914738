// From a settings document and data to a bound problem: what all problems do alike.
#pragma once

#include <memory>
#include <string>
#include <utility>

#include "base/error.h"
#include "base/yaml_reader.h"
#include "datasets/dataset.h"
#include "identify/observation/sensor_effects.h"
#include "problems/bound_problem.h"

namespace sinew {

/// The map under `name`, which is the only key of a settings document. Errors: another key, or none.
inline Result<YamlReader> SettingsSection(const YamlReader& document, const std::string& name) {
  SINEW_TRY(document.OnlyKeys({name}));
  return document.At(name);
}

/// That of the file NAME.yaml of a data set, which must have it. Errors: as above; no YAML.
inline Result<YamlReader> SettingsSection(const Dataset& data, const std::string& name) {
  const std::string file = name + ".yaml";
  SINEW_ASSIGN(const YamlReader document, YamlReader::Parse(data.files.at(file), file));
  return SettingsSection(document, name);
}

/// A problem with its notes. @param behind_sensors it is seen through SensorEffects.
/// Errors: those of making the problem.
template <class P>
Result<BoundProblem> Bound(Result<std::unique_ptr<P>> made, bool behind_sensors) {
  SINEW_ASSIGN(auto problem, std::move(made));
  BoundProblem bound;
  bound.notes = problem->data().notes;
  if (behind_sensors) {
    bound.problem = std::make_unique<SensorEffects>(std::move(problem));
  } else {
    bound.problem = std::move(problem);
  }
  return bound;
}

/// @param read Result<Settings>(const YamlReader& section) @param make Result<BoundProblem>(Settings)
/// Errors: those of SettingsSection, `read` and `make`.
template <class Read, class Make>
Result<BoundProblem> Bind(const std::string& name, const YamlReader& document, Read&& read, Make&& make) {
  SINEW_ASSIGN(const YamlReader section, SettingsSection(document, name));
  SINEW_ASSIGN(auto settings, read(section));
  return make(std::move(settings));
}

}  // namespace sinew
