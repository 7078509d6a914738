#include "models/multibody/osim_functions.h"

#include <algorithm>
#include <cmath>

namespace sinew {
namespace {

// A MultiplierFunction may hold another; real files have one level.
constexpr int kDeepestNesting = 8;

Result<std::vector<double>> FiniteNumbers(const OsimXml& xml, const pugi::xml_node& function,
                                          const char* child) {
  SINEW_ASSIGN(std::vector<double> numbers, xml.Numbers(function, child));
  const bool finite = std::all_of(numbers.begin(), numbers.end(), [](double x) { return std::isfinite(x); });
  if (!finite) return xml.FailAt(function.child(child), "{} of {} is not finite", child, function.name());
  return numbers;
}

Result<double> FiniteNumber(const OsimXml& xml, const pugi::xml_node& function, const char* child,
                            double fallback) {
  SINEW_ASSIGN(const double number, xml.Number(function, child, fallback));
  if (!std::isfinite(number))
    return xml.FailAt(function.child(child), "{} of {} is not finite", child, function.name());
  return number;
}

Result<PiecewisePolynomial> ReadPoints(const OsimXml& xml, const pugi::xml_node& function, bool smooth) {
  SINEW_ASSIGN(const std::vector<double> x, FiniteNumbers(xml, function, "x"));
  SINEW_ASSIGN(const std::vector<double> y, FiniteNumbers(xml, function, "y"));
  auto through = smooth ? PiecewisePolynomial::SimmSpline(x, y) : PiecewisePolynomial::Lines(x, y);
  if (!through) return xml.FailAt(function, "{} {}", function.name(), through.error().message);
  return through;
}

Result<PiecewisePolynomial> ReadCoefficients(const OsimXml& xml, const pugi::xml_node& function) {
  SINEW_ASSIGN(std::vector<double> coefficients, FiniteNumbers(xml, function, "coefficients"));
  if (coefficients.empty()) return xml.FailAt(function, "{} has no coefficients", function.name());
  std::reverse(coefficients.begin(), coefficients.end());  // the file has the highest power first
  return PiecewisePolynomial::Polynomial(std::move(coefficients));
}

Result<PiecewisePolynomial> ReadNested(const OsimXml& xml, const pugi::xml_node& function, int depth) {
  const std::string type = function.name();
  if (type == "Constant") {
    SINEW_ASSIGN(const double value, FiniteNumber(xml, function, "value", 0));
    return PiecewisePolynomial::Constant(value);
  }
  if (type == "LinearFunction") {
    if (!function.child("coefficients")) return PiecewisePolynomial::Linear(1, 0);
    SINEW_ASSIGN(const std::vector<double> coefficients, FiniteNumbers(xml, function, "coefficients"));
    if (coefficients.size() != 2) {
      return xml.FailAt(function, "LinearFunction has {} coefficient(s), expected slope and intercept",
                        coefficients.size());
    }
    return PiecewisePolynomial::Linear(coefficients[0], coefficients[1]);
  }
  if (type == "PolynomialFunction") return ReadCoefficients(xml, function);
  if (type == "SimmSpline" || type == "NaturalCubicSpline" || type == "natCubicSpline")
    return ReadPoints(xml, function, true);
  if (type == "PiecewiseLinearFunction") return ReadPoints(xml, function, false);
  if (type == "MultiplierFunction") {
    const pugi::xml_node inner = FindFunction(function, "function");
    if (!inner) return xml.FailAt(function, "MultiplierFunction holds no function");
    if (depth >= kDeepestNesting) return xml.FailAt(function, "MultiplierFunction is nested too deeply");
    SINEW_ASSIGN(const double scale, FiniteNumber(xml, function, "scale", 1));
    SINEW_ASSIGN(const PiecewisePolynomial unscaled, ReadNested(xml, inner, depth + 1));
    return unscaled.Scaled(scale);
  }
  return xml.FailAt(function,
                    "function {} is not supported; supported are Constant, LinearFunction, SimmSpline, "
                    "NaturalCubicSpline, PiecewiseLinearFunction, PolynomialFunction, MultiplierFunction",
                    type);
}

}  // namespace

pugi::xml_node FindFunction(const pugi::xml_node& owner, const char* property) {
  if (const pugi::xml_node wrapper = owner.child(property)) {
    const auto inside = Elements(wrapper);
    return inside.empty() ? pugi::xml_node() : inside.front();
  }
  return owner.find_child_by_attribute("name", property);
}

Result<PiecewisePolynomial> ReadFunction(const OsimXml& xml, const pugi::xml_node& function) {
  return ReadNested(xml, function, 0);
}

}  // namespace sinew
