// A problem that is bound to data.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "identify/problem.h"

namespace sinew {

/// A problem bound to data, and notes about how it was bound.
struct BoundProblem {
  std::unique_ptr<Problem> problem;
  std::vector<std::string> notes;
};

}  // namespace sinew
