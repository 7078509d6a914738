// Classification of the shape of a curve.
#pragma once

#include <string>
#include <vector>

namespace sinew::diagnosis {

/// Shape of a curve over one signal: its law and how much of the curve's variance that law explains.
struct Shape {
  std::string
      words;  ///< "odd, step at zero", "even, quadratic", "periodic, about 2.1 rad", "no simple shape"
  std::string
      law;  ///< nearest known law for this signal: "Coulomb friction", "quadratic drag", ...; may be empty
  double explained = 0;  ///< share of the curve's variance about its mean that the shape explains (0 to 1)
};

/// @param knots, curve [K] values at the knots @param weight [K] inverse variance of each value; may be empty
/// @param signal name of the signal (position, velocity, ...), which decides the law's name
[[nodiscard]] Shape DescribeShape(const std::vector<double>& knots, const std::vector<double>& curve,
                                  const std::vector<double>& weight, const std::string& signal);

}  // namespace sinew::diagnosis
