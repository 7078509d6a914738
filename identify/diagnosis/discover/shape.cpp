#include "identify/diagnosis/discover/shape.h"

#include <algorithm>
#include <cmath>

#include "base/constants.h"
#include "base/decompositions.h"
#include "base/linear_algebra.h"
#include "base/numbers.h"
#include "base/text.h"

namespace sinew::diagnosis {
namespace {

constexpr double kWell = 0.85;    // least explained share of the variance for a shape to be named
constexpr double kBetter = 0.05;  // least gain in that share per further coefficient

struct Law {
  std::string words;
  std::string name;
  int numbers = 1;  // coefficients besides the mean
  Matrix columns;
};

double Sign(double x) {
  return x > 0 ? 1 : x < 0 ? -1 : 0;
}

std::string LawName(const std::string& kind, const std::string& signal) {
  const bool velocity = signal == "velocity" || signal == "speed";
  if (kind == "linear") {
    return velocity               ? "viscous friction"
           : signal == "position" ? "a spring"
           : signal == "time"     ? "a drift"
                                  : "a gain";
  }
  if (kind == "step") return velocity ? "Coulomb friction" : "";
  if (kind == "quadratic odd")
    return velocity ? "quadratic drag" : signal == "command" ? "gain compression" : "";
  if (kind == "cubic") return signal == "position" ? "a hardening spring" : velocity ? "cubic drag" : "";
  if (kind == "periodic")
    return signal == "position" ? "cogging or ripple" : signal == "time" ? "a periodic disturbance" : "";
  if (kind == "saturating")
    return signal == "command" ? "saturation" : velocity ? "Coulomb friction, smoothed" : "";
  if (kind == "peak") return velocity ? "Stribeck friction" : "";
  return "";
}

double Explained(const Matrix& columns, const Vector& y, const Vector& root_weight) {
  const Matrix a = root_weight.asDiagonal() * columns;
  const Vector b = root_weight.cwiseProduct(y);
  const Vector left = b - a * a.colPivHouseholderQr().solve(b);
  const double total = b.squaredNorm();
  return total > 0 ? 1 - left.squaredNorm() / total : 0;
}

}  // namespace

Shape DescribeShape(const std::vector<double>& knots, const std::vector<double>& curve,
                    const std::vector<double>& weight, const std::string& signal) {
  const auto n = static_cast<Eigen::Index>(knots.size());
  Shape shape;
  if (n < 4) return shape;
  const double reach = std::max(std::abs(knots.front()), std::abs(knots.back()));
  const double span = knots.back() - knots.front();
  Vector y = Eigen::Map<const Vector>(curve.data(), n);
  Vector root(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto at = static_cast<std::size_t>(i);
    root[i] = weight.empty() ? 1 : std::sqrt(std::max(0.0, weight[at]));
  }
  const double total_weight = root.squaredNorm();
  if (!(total_weight > 0)) return shape;
  y.array() -= root.cwiseProduct(root).dot(y) / total_weight;

  const auto column = [&](auto&& f) {
    Matrix columns(n, 2);
    for (Eigen::Index i = 0; i < n; ++i) columns.row(i) << 1, f(knots[static_cast<std::size_t>(i)]);
    return columns;
  };
  std::vector<Law> laws;
  laws.push_back({"a straight line", "linear", 1, column([](double x) { return x; })});
  laws.push_back({"odd, quadratic", "quadratic odd", 1, column([](double x) { return x * std::abs(x); })});
  laws.push_back({"odd, cubic", "cubic", 1, column([](double x) { return x * x * x; })});
  laws.push_back({"even, quadratic", "quadratic", 1, column([](double x) { return x * x; })});
  if (knots.front() < 0 && knots.back() > 0) {
    laws.push_back({"odd, with a step at zero", "step", 1, column(Sign)});
    for (const double width : {0.1, 0.25}) {
      laws.push_back({"odd, saturating", "saturating", 2,
                      column([&](double x) { return std::tanh(x / (width * reach)); })});
      laws.push_back({"odd, largest near zero", "peak", 2, column([&](double x) {
                        return Sign(x) * std::exp(-std::pow(x / (width * reach), 2));
                      })});
    }
  }
  for (int waves = 2; waves <= static_cast<int>(n) / 3; ++waves) {
    Law law{"periodic, about every " + Readable(span / waves, 2), "periodic", 3, Matrix(n, 3)};
    for (Eigen::Index i = 0; i < n; ++i) {
      const double phase = 2 * kPi * waves * (knots[static_cast<std::size_t>(i)] - knots.front()) / span;
      law.columns.row(i) << 1, std::sin(phase), std::cos(phase);
    }
    laws.push_back(std::move(law));
  }
  const Law* best = nullptr;
  double best_value = 0;
  for (const Law& law : laws) {
    const double explained = Explained(law.columns, y, root);
    const double value = explained - kBetter * (law.numbers - 1);
    if (best == nullptr || value > best_value) {
      best = &law;
      best_value = value;
      shape.explained = explained;
    }
  }
  const bool well = shape.explained >= kWell;
  shape.words = well ? best->words : "no simple shape";
  shape.law = LawName(best->name, signal);
  return shape;
}

}  // namespace sinew::diagnosis
