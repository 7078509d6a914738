#include "models/multibody/piecewise_polynomial.h"

#include <algorithm>
#include <cmath>

#include "base/assert.h"

namespace sinew {
namespace {

Status CheckPoints(const std::vector<double>& x, const std::vector<double>& y) {
  if (x.size() != y.size()) return Fail("has {} x but {} y values", x.size(), y.size());
  if (x.size() < 2) return Fail("has {} point(s), expected at least 2", x.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!std::isfinite(x[i]) || !std::isfinite(y[i])) return Fail("point {} is not finite", i + 1);
    if (i > 0 && x[i] <= x[i - 1]) return Fail("x does not increase at point {}", i + 1);
  }
  return {};
}

std::vector<double> Differences(const std::vector<double>& values) {
  std::vector<double> differences;
  for (std::size_t i = 1; i < values.size(); ++i) differences.push_back(values[i] - values[i - 1]);
  return differences;
}

std::vector<double> ChordSlopes(const std::vector<double>& x, const std::vector<double>& y) {
  std::vector<double> slopes = Differences(y);
  for (std::size_t i = 0; i < slopes.size(); ++i) slopes[i] /= x[i + 1] - x[i];
  return slopes;
}

// Third divided difference over the four points that begin at `first`.
double ThirdDifference(const std::vector<double>& x, const std::vector<double>& slope, std::size_t first) {
  const double left = (slope[first + 1] - slope[first]) / (x[first + 2] - x[first]);
  const double right = (slope[first + 2] - slope[first + 1]) / (x[first + 3] - x[first + 1]);
  return (right - left) / (x[first + 3] - x[first]);
}

// A sixth of the spline's second derivative at each point: continuity of the slope at the inner points, the
// given third derivative at the ends; symmetric and tridiagonal, solved by elimination without pivots.
std::vector<double> SixthOfSecondDerivatives(const std::vector<double>& x, const std::vector<double>& slope) {
  const std::size_t n = x.size();
  const std::vector<double> h = Differences(x);
  std::vector<double> diagonal(n);
  std::vector<double> solution(n, 0.0);
  diagonal.front() = -h.front();
  diagonal.back() = -h.back();
  for (std::size_t i = 1; i + 1 < n; ++i) {
    diagonal[i] = 2 * (h[i - 1] + h[i]);
    solution[i] = slope[i] - slope[i - 1];
  }
  if (n > 3) {
    solution.front() = h.front() * h.front() * ThirdDifference(x, slope, 0);
    solution.back() = -h.back() * h.back() * ThirdDifference(x, slope, n - 4);
  }
  for (std::size_t i = 1; i < n; ++i) {
    const double factor = h[i - 1] / diagonal[i - 1];
    diagonal[i] -= factor * h[i - 1];
    solution[i] -= factor * solution[i - 1];
  }
  solution.back() /= diagonal.back();
  for (std::size_t i = n - 1; i-- > 0;) solution[i] = (solution[i] - h[i] * solution[i + 1]) / diagonal[i];
  return solution;
}

}  // namespace

PiecewisePolynomial PiecewisePolynomial::Constant(double value) {
  return Polynomial({value});
}

PiecewisePolynomial PiecewisePolynomial::Linear(double slope, double intercept) {
  return Polynomial({intercept, slope});
}

PiecewisePolynomial PiecewisePolynomial::Polynomial(std::vector<double> coefficients) {
  SINEW_ASSERT(!coefficients.empty(), "a polynomial needs a coefficient");
  return PiecewisePolynomial({{0, std::move(coefficients)}});
}

Result<PiecewisePolynomial> PiecewisePolynomial::Lines(const std::vector<double>& x,
                                                       const std::vector<double>& y) {
  SINEW_TRY(CheckPoints(x, y));
  const std::vector<double> slope = ChordSlopes(x, y);
  std::vector<Piece> pieces;
  for (std::size_t i = 0; i < slope.size(); ++i) pieces.push_back({x[i], {y[i], slope[i]}});
  return PiecewisePolynomial(std::move(pieces), {x.begin() + 1, x.end() - 1});
}

Result<PiecewisePolynomial> PiecewisePolynomial::SimmSpline(const std::vector<double>& x,
                                                            const std::vector<double>& y) {
  if (x.size() == 2) return Lines(x, y);
  SINEW_TRY(CheckPoints(x, y));
  const std::vector<double> slope = ChordSlopes(x, y);
  const std::vector<double> sixth = SixthOfSecondDerivatives(x, slope);
  std::vector<Piece> pieces;
  for (std::size_t i = 0; i < slope.size(); ++i) {
    const double h = x[i + 1] - x[i];
    const double first = slope[i] - h * (sixth[i + 1] + 2 * sixth[i]);
    if (i == 0) pieces.push_back({x[0], {y[0], first}});
    pieces.push_back({x[i], {y[i], first, 3 * sixth[i], (sixth[i + 1] - sixth[i]) / h}});
  }
  const double last_h = x.back() - x[x.size() - 2];
  const double last_slope = slope.back() + last_h * (sixth[x.size() - 2] + 2 * sixth.back());
  pieces.push_back({x.back(), {y.back(), last_slope}});
  return PiecewisePolynomial(std::move(pieces), x);
}

PiecewisePolynomial PiecewisePolynomial::Scaled(double factor) const {
  PiecewisePolynomial scaled = *this;
  for (Piece& piece : scaled.pieces_) {
    for (double& coefficient : piece.coefficients) coefficient *= factor;
  }
  return scaled;
}

PiecewisePolynomial::Value PiecewisePolynomial::At(double x) const {
  const auto index = std::upper_bound(breaks_.begin(), breaks_.end(), x) - breaks_.begin();
  const Piece& piece = pieces_[static_cast<std::size_t>(index)];
  const double t = x - piece.origin;
  Value result;
  double half_second = 0;
  for (auto c = piece.coefficients.rbegin(); c != piece.coefficients.rend(); ++c) {
    half_second = half_second * t + result.first;
    result.first = result.first * t + result.value;
    result.value = result.value * t + *c;
  }
  result.second = 2 * half_second;
  return result;
}

std::optional<double> PiecewisePolynomial::Slope() const {
  if (pieces_.size() > 1) return std::nullopt;
  const std::vector<double>& c = pieces_.front().coefficients;
  for (std::size_t power = 2; power < c.size(); ++power) {
    if (c[power] != 0) return std::nullopt;
  }
  return c.size() > 1 ? c[1] : 0.0;
}

}  // namespace sinew
