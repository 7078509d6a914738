// The options of `sinew simulate nms` that choose where excitations come from, and what is printed of them.
#pragma once

#include <string>

#include "cli/command.h"
#include "problems/nms/excitation/excitation_mode.h"

namespace sinew {

struct ModeOptions {
  std::string type;
  NmsModeChange change;  ///< its type is read from the word by CheckFor

  void AddTo(Command command);
  /// Errors: a problem without modes; a mode that does not exist; options that need another mode.
  Status CheckFor(const std::string& problem);
};

/// What was minimised, per trial; notes to stderr.
void PrintExcitations(const ExcitationMode& mode, bool table);

}  // namespace sinew
