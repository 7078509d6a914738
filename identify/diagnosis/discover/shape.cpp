#include "identify/diagnosis/discover/shape.h"

#include <algorithm>
#include <cmath>

#include "base/constants.h"
#include "base/decompositions.h"
#include "base/linear_algebra.h"

namespace sinew::diagnosis {
namespace {

constexpr double kBetter = 0.05;  // a law with one more number must explain so much more
constexpr double kConstant =
    1e-9;  // variation over the largest value: that of a constant with rounding errors

struct Law {
  ShapeKind kind;
  int numbers;  // besides the mean
  Matrix columns;
  double period = 0;
};

double Sign(double x) {
  return x > 0 ? 1 : x < 0 ? -1 : 0;
}

double Explained(const Matrix& columns, const Vector& y, const Vector& root_weight) {
  const Matrix a = root_weight.asDiagonal() * columns;
  const Vector b = root_weight.cwiseProduct(y);
  const Vector left = b - a * a.colPivHouseholderQr().solve(b);
  const double total = b.squaredNorm();
  return total > 0 ? 1 - left.squaredNorm() / total : 0;
}

}  // namespace

Shape FindShape(const std::vector<double>& knots, const std::vector<double>& curve,
                const std::vector<double>& weight) {
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
  const double largest = y.cwiseAbs().maxCoeff();
  y.array() -= root.cwiseProduct(root).dot(y) / total_weight;
  if (root.cwiseProduct(y).squaredNorm() <= std::pow(kConstant * largest, 2) * total_weight) return shape;

  const auto column = [&](auto&& f) {
    Matrix columns(n, 2);
    for (Eigen::Index i = 0; i < n; ++i) columns.row(i) << 1, f(knots[static_cast<std::size_t>(i)]);
    return columns;
  };
  std::vector<Law> laws;
  laws.push_back({ShapeKind::kLinear, 1, column([](double x) { return x; })});
  laws.push_back({ShapeKind::kQuadraticOdd, 1, column([](double x) { return x * std::abs(x); })});
  laws.push_back({ShapeKind::kCubic, 1, column([](double x) { return x * x * x; })});
  laws.push_back({ShapeKind::kQuadraticEven, 1, column([](double x) { return x * x; })});
  if (knots.front() < 0 && knots.back() > 0) {
    laws.push_back({ShapeKind::kStep, 1, column(Sign)});
    for (const double width : {0.1, 0.25}) {
      laws.push_back(
          {ShapeKind::kSaturating, 2, column([&](double x) { return std::tanh(x / (width * reach)); })});
      laws.push_back({ShapeKind::kPeak, 2, column([&](double x) {
                        return Sign(x) * std::exp(-std::pow(x / (width * reach), 2));
                      })});
    }
  }
  for (int waves = 2; waves <= static_cast<int>(n) / 3; ++waves) {
    Law law{ShapeKind::kPeriodic, 3, Matrix(n, 3), span / waves};
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
  shape.kind = best->kind;
  shape.period = best->period;
  return shape;
}

}  // namespace sinew::diagnosis

namespace sinew {

const char* ToString(ShapeKind kind) {
  switch (kind) {
    case ShapeKind::kNone:
      return "none";
    case ShapeKind::kLinear:
      return "linear";
    case ShapeKind::kQuadraticOdd:
      return "quadratic_odd";
    case ShapeKind::kCubic:
      return "cubic";
    case ShapeKind::kQuadraticEven:
      return "quadratic_even";
    case ShapeKind::kStep:
      return "step";
    case ShapeKind::kSaturating:
      return "saturating";
    case ShapeKind::kPeak:
      return "peak";
    case ShapeKind::kPeriodic:
      return "periodic";
  }
  return "?";
}

}  // namespace sinew
