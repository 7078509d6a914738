// A request of `sinew data synthesize` to a problem's laboratory.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace sinew {

/// Effects to hide, in the order of the command line: name, and numbers by parameter.
using RequestedEffects = std::vector<std::pair<std::string, std::map<std::string, double>>>;

struct SynthesisRequest {
  std::uint64_t seed = 1;
  std::map<std::string, double> set;  ///< true parameters and settings of the experiment by name
  RequestedEffects effects;
  std::optional<double> noise;  ///< factor on all noise; 0 for none
};

}  // namespace sinew
