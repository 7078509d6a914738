// Simbody's integrators by name.
#pragma once

#include <string>
#include <vector>

#include "base/error.h"

namespace sinew {

struct IntegratorEntry {
  std::string name;
  std::string description;
};

/// The first is the default.
[[nodiscard]] const std::vector<IntegratorEntry>& IntegratorRegistry();

/// Errors: no integrator of this name (with a suggestion).
[[nodiscard]] Status CheckIntegrator(const std::string& name);

}  // namespace sinew
