// One descriptor per parameter, the only place where its bounds are stated.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/error.h"

namespace sinew {

/// How a parameter is mapped to the solver's variable in [0, 1]: equal steps of the variable are equal
/// differences of the parameter, or equal ratios (then lower > 0).
enum class Scale { kLinear, kLog };

/// Prior knowledge of a parameter; mean and deviation in its unit (of its natural logarithm for kLog).
struct GaussianPrior {
  double mean = 0;
  double standard_deviation = 1;
};

/// Base parameters are what `identify` fits. Nuisance parameters (an initial state, a per-trial offset) are
/// fitted too but not reported as results. Effect parameters are held at their null value, where the effect
/// vanishes, until the effect is released. Parameters of priors say what is expected of nuisance values (how
/// smooth an error is); no least squares can fit them: they are held, or chosen by the marginal likelihood
/// before the search (solvers::ChoosePriors).
enum class ParameterKind { kBase, kNuisance, kEffect, kPrior };

struct Parameter {
  std::string name;
  std::string unit;     ///< SI; "1" if it has none
  std::string meaning;  ///< one phrase
  double lower = 0;     ///< finite
  double upper = 1;     ///< finite, > lower
  double start = 0;     ///< within the bounds; stated by the problem, never the middle by default
  Scale scale = Scale::kLinear;
  /// Where searches should begin as well, because the cost has several minima along this parameter (a lag);
  /// within the bounds. Solver `starts` uses them. kPrior: the value is chosen, unless there are none.
  std::vector<double> other_starts;
  std::string source;  ///< author, year, equation
  std::string
      below_lower;  ///< what it means if the best value would lie below the lower bound, a clause; or empty
  std::vector<std::string> shared_by;  ///< of what it is a property, if of several: the muscles of a group
  std::optional<GaussianPrior> prior;

  ParameterKind kind = ParameterKind::kBase;
  std::string trial;           ///< the only trial that depends on it; empty if all share it
  std::string effect;          ///< kEffect: the effect that releases it
  double null_value = 0;       ///< kEffect: where the effect vanishes, within the bounds
  std::vector<double> probes;  ///< kEffect: values to score at if the prediction does not depend on the
                               ///< parameter at the null (a Stribeck velocity)
  /// kEffect: if > 0, the prediction is not differentiable at the null (backlash has a kink there) or does
  /// not change near it: the reported slope there is a secant over about this step [unit].
  double null_step = 0;
  /// kEffect: the prediction is rounded to multiples of this parameter unless it is at its null (a quantised
  /// reading). Derivatives are those of the prediction before rounding.
  bool is_rounding_step = false;

  /// The value of a parameter that is not fitted: the null of an effect, the start of all others.
  [[nodiscard]] double rest_value() const { return kind == ParameterKind::kEffect ? null_value : start; }
};

/// A base parameter on a linear scale.
[[nodiscard]] Parameter BaseParameter(std::string name, std::string unit, std::string meaning, double lower,
                                      double upper, double start);

/// A parameter of an effect, on a linear scale, that starts at its null value.
[[nodiscard]] Parameter EffectParameter(std::string name, std::string unit, std::string meaning, double lower,
                                        double upper, double null, std::string effect);

/// Checks names (unique, not empty), bounds, starts, nulls and scales; the error names parameter, value and
/// constraint.
[[nodiscard]] Status CheckParameters(const std::vector<Parameter>& parameters);

/// Index of a parameter; the error for an unknown name suggests the closest one.
Result<int> FindParameter(const std::vector<Parameter>& parameters, const std::string& name);

}  // namespace sinew
