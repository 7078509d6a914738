// What is to be found: one descriptor per parameter, the only home of its bounds.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/error.h"

namespace sinew {

/// How a parameter is stepped by a solver: by differences, or by ratios (then lower > 0).
enum class Scale { kLinear, kLog };

/// What is known of a parameter before the data speak; mean and deviation in its unit (of its logarithm for
/// kLog).
struct GaussianPrior {
  double mean = 0;
  double standard_deviation = 1;
};

/// Base parameters are what `identify` frees. Nuisance values (an initial state, a per-trial offset) are
/// fitted too but are no findings. Effect parameters rest at their null value, where the effect vanishes,
/// until the effect is released.
enum class ParameterKind { kBase, kNuisance, kEffect };

struct Parameter {
  std::string name;
  std::string unit;     ///< SI; "1" if it has none
  std::string meaning;  ///< one phrase for a person
  double lower = 0;     ///< finite
  double upper = 1;     ///< finite, > lower
  double start = 0;     ///< within the bounds; stated, never "the middle"
  Scale scale = Scale::kLinear;
  std::string source;  ///< author, year, equation
  std::optional<GaussianPrior> prior;

  ParameterKind kind = ParameterKind::kBase;
  std::string trial;           ///< the trial that alone depends on it; empty if all share it
  std::string effect;          ///< kEffect: the effect that releases it
  double null_value = 0;       ///< kEffect: where the effect vanishes, within the bounds
  std::vector<double> probes;  ///< kEffect: values to try where the null says nothing (a Stribeck velocity)
  /// kEffect: if > 0, the prediction has a kink at the null (backlash) or does not change near it: its slope
  /// there is a secant over about this step [unit], not the derivative.
  double null_step = 0;

  /// The value outside of a fit: the null of an effect, the start of all others.
  [[nodiscard]] double rest_value() const { return kind == ParameterKind::kEffect ? null_value : start; }
};

/// A base parameter on a linear scale.
[[nodiscard]] Parameter BaseParameter(std::string name, std::string unit, std::string meaning, double lower,
                                      double upper, double start);

/// A parameter of an effect, at rest where the effect vanishes.
[[nodiscard]] Parameter EffectParameter(std::string name, std::string unit, std::string meaning, double lower,
                                        double upper, double null, std::string effect);

/// Checks names (unique, not empty), bounds, starts, nulls and scales; the error names parameter, value and
/// constraint.
[[nodiscard]] Status CheckParameters(const std::vector<Parameter>& parameters);

/// Index of a parameter; the error suggests the name that was probably meant.
Result<int> FindParameter(const std::vector<Parameter>& parameters, const std::string& name);

}  // namespace sinew
