// CEINMS-RT's execution file (<execution>), as far as its calibration uses it: which tendon.
#pragma once

#include <string>
#include <vector>

#include "base/error.h"

namespace sinew {

struct CeinmsRtExecution {
  std::string tendon = "rigid";  ///< as nms.yaml has it
  std::vector<std::string> notes;
};

/// Errors, with file and line: another document, a tendon that CEINMS-RT does not have, an activation or a
/// kind of execution that it cannot calibrate.
Result<CeinmsRtExecution> ReadCeinmsRtExecution(const std::string& text, const std::string& file);

}  // namespace sinew
