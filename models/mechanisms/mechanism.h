// The five mechanisms on which the simulator is validated: the IFToMM "Library of Computational Benchmark
// Problems" (Gonzalez, Dopico, Lugris, Cuadrado 2006), as Simbody models, each with a point whose path is
// compared.
#pragma once

#include <string>
#include <vector>

#include "base/error.h"
#include "base/linear_algebra.h"

namespace sinew {

/// One way to write down a mechanism: which joints make the tree, and what closes the loops.
struct MechanismFormulation {
  std::string name;
  std::string description;
};

struct Mechanism {
  std::string name;   ///< A01
  std::string title;  ///< simple pendulum
  std::string challenge;
  std::string point;                     ///< whose path is compared
  std::vector<std::string> coordinates;  ///< of that point, in `unit`
  std::string unit;
  double duration = 10;                            ///< [s]
  double threshold = 1e-3;                         ///< of equation 3.1 [unit]
  std::vector<MechanismFormulation> formulations;  ///< the first is the default
};

/// A01 to A05, and A03-IVP: Andrews' mechanism from the start of the IVP test set (Mazzia, Magherini 2008),
/// whose seven angles at 0.03 s are known.
[[nodiscard]] const std::vector<Mechanism>& MechanismRegistry();

/// Errors: no mechanism of this name (with a suggestion).
[[nodiscard]] Result<Mechanism> FindMechanism(const std::string& name);

}  // namespace sinew
