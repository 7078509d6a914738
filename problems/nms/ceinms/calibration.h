// A CEINMS calibration or execution as settings of the nms problem.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/error.h"

namespace sinew {

/// One parameter: its entry of nms.yaml, such as "{share: single, lower: -3, upper: 0}".
struct CeinmsParameter {
  std::string name;
  std::string entry;
};

/// <hybrid> of an execution; weights are those of ExcitationWeights.
struct CeinmsHybrid {
  double alpha = 1;
  double beta = 0;
  double gamma = 0;
  std::vector<std::string> synthesise;
  std::vector<std::string> adjust;
  std::vector<std::string> joints;  ///< empty: all
  long line = 0;                    ///< of <hybrid>
};

/// One of <calibrationSteps>.
struct CeinmsStep {
  std::vector<std::string> joints;      ///< empty: all
  std::vector<std::string> parameters;  ///< as nms.yaml has them
};

struct CeinmsCalibration {
  std::string tendon = "rigid";            ///< as nms.yaml has it
  std::string activation = "exponential";  ///< as nms.yaml has it
  std::vector<std::string> joints;         ///< empty: all of the subject
  std::vector<CeinmsParameter> parameters;
  std::vector<CeinmsStep> steps;
  bool fibre_range = false;            ///< fibres are drawn into 0.5 .. 1.5 optimal lengths
  std::optional<CeinmsHybrid> hybrid;  ///< else open loop
  std::vector<std::string> trials;     ///< files, as written
  std::vector<std::string> notes;
};

/// <calibration> or <execution>. Errors, with file and line: another document, unknown elements where they
/// change the answer, ranges that are none.
Result<CeinmsCalibration> ReadCeinmsCalibration(const std::string& text, const std::string& file);

/// nms.yaml.
[[nodiscard]] std::string SettingsText(const CeinmsCalibration& calibration);

}  // namespace sinew
