#include "models/mechanisms/mechanism.h"

#include "base/text.h"

namespace sinew {

const std::vector<Mechanism>& MechanismRegistry() {
  static const std::vector<Mechanism> registry = [] {
    return std::vector<Mechanism>{
        {"A01",
         "simple pendulum",
         "dynamics",
         "the mass",
         {"x", "y"},
         "m",
         10,
         1e-3,
         {{"tree", "one hinge"}}},
        {"A02",
         "40 four-bar windows",
         "singular positions",
         "the first top B0",
         {"x", "y"},
         "m",
         10,
         1e-3,
         {{"merged", "what turns alike is one body, what stays level a point mass: one hinge"},
          {"couplers", "81 hinges, 80 linear couplings of their angles: windows stay parallelograms"},
          {"loops", "81 hinges, 40 loops closed by points in planes"}}},
        {"A03",
         "Andrews' squeezer",
         "small time scale",
         "the end F of the crank",
         {"x", "y"},
         "m",
         0.05,
         1e-5,
         {{"tree", "seven hinges, three loops closed at E"}}},
        {"A04",
         "Bricard's mechanism",
         "redundant constraints",
         "the third hinge",
         {"x", "y", "z"},
         "m",
         10,
         1e-3,
         {{"end", "a chain of five hinges, the sixth is a constraint"},
          {"middle",
           "chains of three and two rods from both sides, the hinge between them is a constraint"}}},
        {"A05",
         "flyball governor",
         "stiffness",
         "the slider",
         {"s"},
         "m",
         10,
         1e-3,
         {{"tree", "four joints"}}},
        {"A03-IVP",
         "Andrews' squeezer from the start of the IVP test set",
         "small time scale",
         "the seven angles",
         {"beta", "Theta", "gamma", "Phi", "delta", "Omega", "epsilon"},
         "rad",
         0.03,
         1e-5,
         {{"tree", "seven hinges, three loops closed at E"}}}};
  }();
  return registry;
}

Result<Mechanism> FindMechanism(const std::string& name) {
  std::vector<std::string> names;
  for (const Mechanism& mechanism : MechanismRegistry()) {
    if (mechanism.name == name) return mechanism;
    names.push_back(mechanism.name);
  }
  return Fail("mechanism '{}' does not exist{}", name, Suggestion(name, names));
}

}  // namespace sinew
