// What can be missing from a model: effects (named groups of parameters that can be released), ports at which
// a model discrepancy term can be added, and linear constraints.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/linear_algebra.h"
#include "base/linear_basis.h"

namespace sinew {

/// The level of a human-robot interaction that an effect belongs to.
enum class Level { kHuman, kRobot, kBoundary, kSensor };

[[nodiscard]] const char* ToString(Level level);

/// How often an effect is found in practice, by the judgement of whoever declares it. It decides between
/// causes that data do not distinguish, and nothing else.
enum class Occurrence { kCommon = 0, kOccasional = 1, kRare = 2 };

/// "common", "occasional", "rare".
[[nodiscard]] const char* ToString(Occurrence occurrence);

/// A named group of parameters whose null value makes it vanish; releasing it extends the model.
struct Effect {
  std::string name;
  Level level = Level::kSensor;
  std::string description;  ///< the cause as a sentence: "the force plate reads too high by a constant"
  std::string revealing_experiment;  ///< an experiment in which the effect is large
  std::vector<int> parameters;       ///< indices into Problem::parameters()
  std::string trial = {};            ///< the only trial that it acts in; empty: all (the default)
  Occurrence occurrence = Occurrence::kOccasional;
};

/// A model discrepancy term: a smooth function of one signal that can be added at a port, piecewise linear
/// between the knots and constant beyond the outer ones (weights times linear basis functions). The weights
/// are parameters (kEffect, null 0) whose `effect` is this term's name, so that a term is scored, released
/// and refitted like any effect.
/// Source: Kennedy, O'Hagan (2001), J. R. Stat. Soc. B 63:425-464, for the discrepancy term.
struct DiscrepancyTerm {
  std::string name;    ///< PORT(SIGNAL), such as torque(position)
  std::string signal;  ///< position, velocity, command, time, ...
  std::string signal_unit;
  std::vector<double> knots;    ///< [K, increasing, unit of the signal]
  std::vector<int> parameters;  ///< [K] indices into Problem::parameters(): the weights [unit of the port]
  /// Only fitted beside causes that cross-validation has chosen, where these leave more than noise. It takes
  /// part in no test, so that tests for the other candidates do not lose power.
  bool beside_causes = false;
};

/// A place where a discrepancy term can be added (a joint torque, the output itself), with one term per
/// signal that it can depend on there.
struct DiscrepancyPort {
  std::string name;
  std::string unit;
  std::string meaning;
  std::vector<DiscrepancyTerm> terms;  ///< one per signal
};

/// g(theta) = offset + coefficients * theta <= 0, linear in the parameters.
struct Constraint {
  std::string name;
  Vector coefficients;  ///< [P]
  double offset = 0;
};

}  // namespace sinew
