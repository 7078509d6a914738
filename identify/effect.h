// What might be wrong with a model: named groups of parameters that can be released, places where a term that
// nobody knows may enter, and constraints.
#pragma once

#include <optional>
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
  std::string description;  ///< the cause as a sentence: "the force plate reads too much by a constant"
  std::string revealing_experiment;  ///< the experiment that would show it
  std::vector<int> parameters;       ///< indices into Problem::parameters()
  std::string trial = {};            ///< the trial that alone shows it; empty: all of them (the default)
};

/// A smooth function of one signal that may be added at a port: sum of weights times linear hats over the
/// knots, constant beyond the outer ones. The weights are parameters (kEffect, null 0) whose `effect` is this
/// term's name, so that a term is scored, released and refitted like any effect.
struct DiscrepancyTerm {
  std::string name;    ///< PORT(SIGNAL), such as torque(position)
  std::string signal;  ///< position, velocity, command, time, ...
  std::string signal_unit;
  std::vector<double> knots;    ///< [K, increasing, unit of the signal]
  std::vector<int> parameters;  ///< [K] indices into Problem::parameters(): the weights [unit of the port]
};

/// A place where something that nobody thought of may enter (a joint torque, the output itself), and what it
/// may depend on there.
struct DiscrepancyPort {
  std::string name;
  std::string unit;
  std::string meaning;
  std::vector<DiscrepancyTerm> terms;  ///< one per signal
};

/// Values of the hats over `knots` at x: at most two are not zero.
struct LinearBasis {
  int first = 0;          ///< index of the left one
  double left = 1;        ///< value of hat `first`
  double right = 0;       ///< value of hat `first` + 1
  double left_slope = 0;  ///< d/dx of `left`; that of `right` is its negative
};
[[nodiscard]] LinearBasis LinearBasisAt(const std::vector<double>& knots, double x);

/// g(theta) = offset + coefficients * theta <= 0, linear in the parameters.
struct Constraint {
  std::string name;
  Vector coefficients;  ///< [P]
  double offset = 0;
};

}  // namespace sinew
