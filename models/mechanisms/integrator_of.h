// Makes Simbody's integrators; it includes Simbody's headers.
#pragma once

#include <Simbody.h>

#include <memory>
#include <string>

namespace sinew {

/// @param name one of IntegratorRegistry
[[nodiscard]] std::unique_ptr<SimTK::Integrator> NewIntegrator(const std::string& name,
                                                               const SimTK::System& system);

}  // namespace sinew
