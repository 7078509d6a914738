// What `sinew data synthesize` takes with --set and --noise, for problems that list their settings in an
// array of structs with name, value (the default), lower, upper and description.
#pragma once

#include <algorithm>
#include <initializer_list>
#include <iterator>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/error.h"
#include "base/numbers.h"
#include "base/text.h"
#include "problems/synthesis_request.h"

namespace sinew {

/// Everything that --set takes, with its default and range.
struct ExperimentSetting {
  const char* name;
  double value;
  double lower;
  double upper;
  const char* description;
};

/// Errors: no such setting (with a suggestion), or a value out of its range.
template <class Setting, std::size_t N>
Result<const Setting*> FindSetting(const Setting (&settings)[N], const std::string& name, double value) {
  const auto* found = std::find_if(std::begin(settings), std::end(settings),
                                   [&](const Setting& s) { return name == s.name; });
  if (found == std::end(settings)) {
    std::vector<std::string> names;
    for (const Setting& setting : settings) names.emplace_back(setting.name);
    return Fail("--set: '{}' does not exist{}", name, Suggestion(name, names));
  }
  if (!(value >= found->lower && value <= found->upper))
    return Fail("--set {}={}: expected {} to {}", name, value, found->lower, found->upper);
  return found;
}

/// Multiplies the values of these names. @param factor [>= 0] of --noise, if it was given.
inline Status ScaleNoise(const std::optional<double>& factor, std::initializer_list<const char*> names,
                         std::map<std::string, double>& values) {
  if (!factor) return {};
  if (!(*factor >= 0)) return Fail("--noise {}: expected a factor of at least 0", *factor);
  for (const char* name : names) values[name] *= *factor;
  return {};
}

/// Value of every setting by name: its default, or that of --set. @param noise scaled by --noise
/// Errors: FindSetting's, ScaleNoise's.
template <std::size_t N>
Result<std::map<std::string, double>> ReadExperiment(const ExperimentSetting (&settings)[N],
                                                     std::initializer_list<const char*> noise,
                                                     const SynthesisRequest& request) {
  std::map<std::string, double> values;
  for (const ExperimentSetting& setting : settings) values[setting.name] = setting.value;
  for (const auto& [name, value] : request.set) {
    SINEW_TRY(FindSetting(settings, name, value));
    values[name] = value;
  }
  SINEW_TRY(ScaleNoise(request.noise, noise, values));
  return values;
}

/// Name and default of every setting.
template <class Setting, std::size_t N>
std::vector<std::pair<std::string, std::string>> DescribeSettings(const Setting (&settings)[N]) {
  std::vector<std::pair<std::string, std::string>> described;
  for (const Setting& setting : settings) {
    described.emplace_back(setting.name,
                           fmt::format("{} (default {})", setting.description, Readable(setting.value)));
  }
  return described;
}

/// train_1, ..., validate_1, ... of trial `index` from 0.
inline std::string SyntheticTrialName(std::size_t index, std::size_t train) {
  return index < train ? fmt::format("train_{}", index + 1) : fmt::format("validate_{}", index - train + 1);
}

}  // namespace sinew
