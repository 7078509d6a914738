// Every problem that the program knows, in one visible list.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/error.h"
#include "base/yaml_reader.h"
#include "datasets/dataset.h"
#include "identify/problem.h"

namespace sinew {

/// A problem bound to data, and what a person should know about how it was bound.
struct BoundProblem {
  std::unique_ptr<Problem> problem;
  std::vector<std::string> notes;
};

/// What `sinew data synthesize` asks for.
struct SynthesisRequest {
  std::uint64_t seed = 1;
  std::map<std::string, double> set;  ///< true parameters and settings of the experiment by name
  std::vector<std::pair<std::string, std::map<std::string, double>>> effects;  ///< name, parameters
  std::optional<double> noise;  ///< factor on all noise; 0 for none
};

/// What a problem of somebody else's lacks is nullptr: `synthesize`, `parameters`, `experiment`.
struct ProblemEntry {
  std::string name;
  std::string description;  ///< one line for `sinew list problems`
  std::string channels;     ///< text for `sinew list channels`
  /// @param settings the document of --config, or of the data set's file NAME.yaml.
  Result<BoundProblem> (*bind)(const Dataset& data, const YamlReader& settings, bool with_sensor_effects);
  Result<Dataset> (*synthesize)(const SynthesisRequest& request);
  /// The parameters with default ranges, without data.
  std::vector<Parameter> (*parameters)();
  /// Names and defaults of what `--set` takes besides the parameters.
  std::vector<std::pair<std::string, std::string>> (*experiment)();
  /// Without NAME.yaml and --config, the settings are `NAME: {}`.
  bool settings_optional = false;
};

[[nodiscard]] const std::vector<ProblemEntry>& ProblemRegistry();

/// Errors: no such problem, with a suggestion.
Result<const ProblemEntry*> FindProblem(const std::string& name);
Result<const ProblemEntry*> FindProblem(const std::vector<ProblemEntry>& problems, const std::string& name);

}  // namespace sinew
