// What might be wrong with a model: named groups of parameters that can be released, places where a term that
// nobody knows may enter, and constraints.
#pragma once

#include <string>
#include <vector>

#include "base/linear_algebra.h"

namespace sinew {

/// The level of a human-robot interaction that an effect belongs to.
enum class Level { kHuman, kRobot, kBoundary, kSensor };

[[nodiscard]] const char* ToString(Level level);

/// A named group of parameters whose null value makes it vanish; releasing it extends the model.
struct Effect {
  std::string name;
  Level level = Level::kSensor;
  std::string says;             ///< the cause as a sentence: "the force plate reads too much by a constant"
  std::string exposed_by;       ///< the experiment that would show it
  std::vector<int> parameters;  ///< indices into Problem::parameters()
};

/// A place where an unknown term may enter (a joint torque, the output itself), and what it may depend on
/// there.
struct Port {
  std::string name;
  std::string unit;
  std::string meaning;
  std::vector<std::string> signals;  ///< such as position, velocity, phase, time
};

/// A smooth function of one signal, added at one port: sum of weights times linear B-splines (hats) over the
/// knots, constant beyond the outer ones.
struct UnknownTerm {
  int port = 0;
  int signal = 0;
  std::vector<double> knots;  ///< [K, increasing, unit of the signal]
  Vector weights;             ///< [K, unit of the port]

  [[nodiscard]] double Value(double signal_value) const;
};

/// g(theta) = offset + coefficients * theta <= 0, linear in the parameters.
struct Constraint {
  std::string name;
  Vector coefficients;  ///< [P]
  double offset = 0;
};

}  // namespace sinew
