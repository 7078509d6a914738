#include "models/emg/shape_basis.h"

#include <cmath>

#include "base/assert.h"
#include "base/constants.h"
#include "base/decompositions.h"

namespace sinew {
namespace {

// Of second differences, beside squares of the data: decides only where these are silent.
constexpr double kSmoothing = 1e-12;
constexpr int kTable = 1024;
constexpr int kHarmonicsPerKnot = 6;  // of the spline; their coefficients fall with the eighth power
constexpr int kFilterOrder = 4;       // forward and backward, see envelope.h

double Sinc(double x) {
  return x == 0 ? 1 : std::sin(kPi * x) / (kPi * x);
}

}  // namespace

ShapeBasis::ShapeBasis(int knots, double harmonics, double jitter) : knots_(knots) {
  SINEW_ASSERT(knots >= kMinKnots, "a cubic spline on a circle needs four knots");
  if (!(harmonics > 0) && !(jitter > 0)) return;
  std::vector<double> coefficients;
  for (int n = 0; n <= kHarmonicsPerKnot * knots; ++n) {
    const double turn = 2 * kPi * n * jitter;
    const double filtered = harmonics > 0 ? 1 / (1 + std::pow(n / harmonics, kFilterOrder)) : 1;
    coefficients.push_back(std::pow(Sinc(static_cast<double>(n) / knots), 4) / knots * filtered *
                           std::exp(-0.5 * turn * turn));
  }
  for (int i = 0; i <= kTable; ++i) {
    One one{coefficients[0], 0};
    for (int n = 1; n < static_cast<int>(coefficients.size()); ++n) {
      const double turn = 2 * kPi * n;
      const double angle = turn * i / kTable;
      one.value += 2 * coefficients[static_cast<std::size_t>(n)] * std::cos(angle);
      one.slope -= 2 * turn * coefficients[static_cast<std::size_t>(n)] * std::sin(angle);
    }
    table_.push_back(one);
  }
}

// Cubic between the table's values and slopes, so that value and slope belong together exactly.
ShapeBasis::One ShapeBasis::OneAt(double phase) const {
  const double place = (phase - std::floor(phase)) * kTable;
  const auto i = std::min(static_cast<std::size_t>(place), static_cast<std::size_t>(kTable - 1));
  const double u = place - static_cast<double>(i);
  const One& a = table_[i];
  const One& b = table_[i + 1];
  const double rise = (b.value - a.value) * kTable;
  const double from = a.slope - rise;
  const double to = b.slope - rise;
  One one;
  one.value = a.value + u * (b.value - a.value) + u * (1 - u) * ((1 - u) * from - u * to) / kTable;
  one.slope = rise + (1 - u) * (1 - 3 * u) * from + u * (3 * u - 2) * to;
  return one;
}

void ShapeBasis::At(double phase, double* values, double* slopes) const {
  if (!table_.empty()) {
    for (int j = 0; j < knots_; ++j) {
      const One one = OneAt(phase - static_cast<double>(j) / knots_);
      values[j] = one.value;
      if (slopes != nullptr) slopes[j] = one.slope;
    }
    return;
  }
  std::fill(values, values + knots_, 0.0);
  if (slopes != nullptr) std::fill(slopes, slopes + knots_, 0.0);
  const double place = (phase - std::floor(phase)) * knots_;
  const double whole = std::floor(place);
  const double u = place - whole;
  const double v = 1 - u;
  const std::array<double, 4> value{v * v * v / 6, (3 * u * u * u - 6 * u * u + 4) / 6,
                                    (3 * v * v * v - 6 * v * v + 4) / 6, u * u * u / 6};
  const std::array<double, 4> slope{-v * v / 2, (3 * u * u - 4 * u) / 2, -(3 * v * v - 4 * v) / 2, u * u / 2};
  for (int i = 0; i < 4; ++i) {
    const int j = (static_cast<int>(whole) + knots_ - 1 + i) % knots_;
    values[j] += value[static_cast<std::size_t>(i)];
    if (slopes != nullptr) slopes[j] += knots_ * slope[static_cast<std::size_t>(i)];
  }
}

double ShapeBasis::Value(double phase, const double* control) const {
  Vector values(knots_);
  At(phase, values.data(), nullptr);
  return values.dot(Eigen::Map<const Vector>(control, knots_));
}

double ShapeBasis::Slope(double phase, const double* control) const {
  Vector values(knots_);
  Vector slopes(knots_);
  At(phase, values.data(), slopes.data());
  return slopes.dot(Eigen::Map<const Vector>(control, knots_));
}

Result<Vector> FitShape(const std::vector<double>& phase, const std::vector<double>& values,
                        const ShapeBasis& basis) {
  const int knots = basis.knots();
  if (phase.size() != values.size())
    return Fail("{} phases and {} values, expected as many", phase.size(), values.size());
  if (phase.size() < static_cast<std::size_t>(knots))
    return Fail("{} samples are too few for {} control points", phase.size(), knots);
  Matrix normal = Matrix::Zero(knots, knots);
  Vector right = Vector::Zero(knots);
  Vector row(knots);
  for (std::size_t i = 0; i < phase.size(); ++i) {
    if (!std::isfinite(phase[i]) || !std::isfinite(values[i])) return Fail("sample {} is no number", i);
    basis.At(phase[i], row.data(), nullptr);
    right += values[i] * row;
    normal += row * row.transpose();
  }
  const double weight = kSmoothing * normal.diagonal().mean();
  for (int j = 0; j < knots; ++j) {
    const std::array<int, 3> at{(j + knots - 1) % knots, j, (j + 1) % knots};
    constexpr std::array<double, 3> kDifference{1, -2, 1};
    for (std::size_t a = 0; a < 3; ++a) {
      for (std::size_t b = 0; b < 3; ++b) normal(at[a], at[b]) += weight * kDifference[a] * kDifference[b];
    }
  }
  const Vector control = Eigen::LDLT<Matrix>(normal).solve(right);
  if (!control.allFinite()) return Fail("the samples do not determine a curve");
  return control;
}

}  // namespace sinew
