// Where the excitations of muscles come from: measured, adjusted, or found. SCIENCE section 3 (modes).
//
//   nms:
//     mode: {type: hybrid, alpha: 1, beta: 2, gamma: 3, synthesise: [psoas_r], adjust: [soleus_r],
//            joints: [knee_angle_r]}
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/yaml_reader.h"
#include "datasets/dataset.h"
#include "problems/nms/excitation/frame.h"
#include "problems/nms/muscle/subject.h"

namespace sinew {

enum class NmsModeType {
  kOpenLoop,  ///< all measured
  kHybrid,    ///< those of some muscles are found: of those without EMG, unless listed otherwise
  kAssisted,  ///< besides, the measured ones are adjusted: all, unless listed otherwise
  kOptimised  ///< all are found; EMG is not looked at
};

struct NmsMode {
  NmsModeType type = NmsModeType::kOpenLoop;
  ExcitationWeights weights;  ///< as in the example of CEINMS's manual
  std::optional<std::vector<std::string>> synthesise;
  std::optional<std::vector<std::string>> adjust;
  std::vector<std::string> joints;  ///< whose moments are followed; empty: all that are measured
};

/// Errors: no such mode, with a suggestion.
Result<NmsModeType> ParseNmsMode(const std::string& word);
[[nodiscard]] std::string ToString(NmsModeType type);

/// The key `mode`. @param muscles, joints of the problem. Errors, with file and line: an unknown type, muscle
/// or joint; a weight that is none.
Result<NmsMode> ReadNmsMode(const YamlReader& yaml, const std::vector<std::string>& muscles,
                            const std::vector<std::string>& joints);

/// Which muscles are free, for a data set.
struct FreeMuscles {
  std::vector<std::string> synthesised;  ///< found without EMG
  std::vector<std::string> adjusted;     ///< found, near their EMG
  std::vector<std::string> notes;
};

/// @param mode any but open loop @param muscles of the problem
/// Errors: a muscle that does not exist, or is in both lists; one that is neither measured nor synthesised;
/// lists that leave nothing free or make no sense of the mode; weights that are none.
Result<FreeMuscles> ChooseFreeMuscles(const NmsMode& mode, const std::vector<std::string>& muscles,
                                      const Subject& subject, const Dataset& data);

/// Names of the signals that excite the muscle: those of the subject's channels, else its own.
[[nodiscard]] std::vector<std::string> ExcitationSources(const Subject& subject, const std::string& muscle);

}  // namespace sinew
