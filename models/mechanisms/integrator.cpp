#include "models/mechanisms/integrator.h"

#include "base/assert.h"
#include "base/text.h"
#include "models/mechanisms/integrator_of.h"

namespace sinew {

const std::vector<IntegratorEntry>& IntegratorRegistry() {
  static const std::vector<IntegratorEntry> entries{
      {"rk_merson",
       "Runge-Kutta-Merson 4(3), explicit, adaptive; keeps best to the accuracy that is asked for"},
      {"rk_feldberg", "Runge-Kutta-Fehlberg 5(4), explicit, adaptive; what the thesis used"},
      {"rk3", "Runge-Kutta 3(2), explicit, adaptive"},
      {"cpodes_bdf", "backward differences of order 1 to 5, implicit, adaptive (CPODES); for stiff systems"},
      {"cpodes_adams", "Adams-Moulton of order 1 to 12, functional iteration (CPODES)"},
      {"verlet", "velocity Verlet, order 2, adaptive"},
      {"semi_explicit_euler2", "semi-explicit Euler with step doubling, order 1; fast at low accuracy"}};
  return entries;
}

Status CheckIntegrator(const std::string& name) {
  std::vector<std::string> names;
  for (const IntegratorEntry& entry : IntegratorRegistry()) {
    if (entry.name == name) return {};
    names.push_back(entry.name);
  }
  return Fail("integrator '{}' does not exist{}", name, Suggestion(name, names));
}

std::unique_ptr<SimTK::Integrator> NewIntegrator(const std::string& name, const SimTK::System& system) {
  if (name == "rk_feldberg") return std::make_unique<SimTK::RungeKuttaFeldbergIntegrator>(system);
  if (name == "rk_merson") return std::make_unique<SimTK::RungeKuttaMersonIntegrator>(system);
  if (name == "rk3") return std::make_unique<SimTK::RungeKutta3Integrator>(system);
  if (name == "cpodes_bdf") return std::make_unique<SimTK::CPodesIntegrator>(system, SimTK::CPodes::BDF);
  if (name == "cpodes_adams")
    return std::make_unique<SimTK::CPodesIntegrator>(system, SimTK::CPodes::Adams, SimTK::CPodes::Functional);
  if (name == "verlet") return std::make_unique<SimTK::VerletIntegrator>(system);
  SINEW_ASSERT(name == "semi_explicit_euler2", "an integrator of the registry");
  return std::make_unique<SimTK::SemiExplicitEuler2Integrator>(system);
}

}  // namespace sinew
