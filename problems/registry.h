// Every problem of the program, in one visible list.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "base/error.h"
#include "base/yaml_reader.h"
#include "datasets/dataset.h"
#include "identify/parameter.h"
#include "problems/bound_problem.h"
#include "problems/synthesis_request.h"

namespace sinew {

/// `synthesize`, `parameters` and `experiment` may be nullptr: a user's own problem need not have them.
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
