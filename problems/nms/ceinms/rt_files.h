// Where the files lie that CEINMS-RT's XML names.
#pragma once

#include <string>

#include "base/error.h"

namespace sinew {

/// A file as an element names it.
struct CeinmsRtName {
  std::string calibration;  ///< the file that names it
  long line = 0;
  std::string element;  ///< for messages: "<osimFile>"
  std::string written;  ///< with / or, as on Windows, with backslashes
  int kept = 1;         ///< so many of its last parts stay together: 2 for TRIAL/ik.sto
};

/// CEINMS-RT takes names relative to the folder that it was started in, which holds cfg/. That folder is
/// looked for: the working folder, then the folder of the calibration file and those above it. A project
/// whose files were moved is found beside its calibration file: written parts are left out from the front,
/// cfg/Model/data/walk/ik.sto being data/walk/ik.sto and walk/ik.sto.
/// Errors: the file is in none of these places, which are named.
Result<std::string> FindCeinmsRtFile(const CeinmsRtName& name);

}  // namespace sinew
