#include "models/muscle/muscle_curve.h"

#include <algorithm>
#include <cmath>

#include "base/spline.h"

namespace sinew {
namespace {

// A cubic per interval, by values and slopes at the points; straight lines beyond.
class Hermite {
 public:
  struct Taylor {
    double integral = 0;  // from the first point
    double value = 0;
    double first = 0;
    double second = 0;
    double third = 0;
  };

  Hermite(const std::vector<double>& x, const std::vector<double>& y, std::vector<double> slopes)
      : x_(x), y_(y), slopes_(std::move(slopes)), integrals_{0} {
    for (std::size_t i = 0; i + 1 < x_.size(); ++i) {
      const double h = x_[i + 1] - x_[i];
      integrals_.push_back(integrals_.back() + 0.5 * h * (y_[i] + y_[i + 1]) +
                           h * h / 12 * (slopes_[i] - slopes_[i + 1]));
    }
  }

  /// Of the piece on the right of x.
  [[nodiscard]] Taylor At(double x) const {
    if (x < x_.front()) return Line(x - x_.front(), y_.front(), slopes_.front(), 0);
    if (x >= x_.back()) return Line(x - x_.back(), y_.back(), slopes_.back(), integrals_.back());
    const auto i = static_cast<std::size_t>(std::upper_bound(x_.begin(), x_.end(), x) - x_.begin()) - 1;
    const double h = x_[i + 1] - x_[i];
    const double rise = (y_[i + 1] - y_[i]) / h;
    const double c2 = (3 * rise - 2 * slopes_[i] - slopes_[i + 1]) / h;
    const double c3 = (slopes_[i] + slopes_[i + 1] - 2 * rise) / (h * h);
    const double s = x - x_[i];
    return {integrals_[i] + s * (y_[i] + s * (slopes_[i] / 2 + s * (c2 / 3 + s * c3 / 4))),
            y_[i] + s * (slopes_[i] + s * (c2 + s * c3)), slopes_[i] + s * (2 * c2 + s * 3 * c3),
            2 * c2 + 6 * s * c3, 6 * c3};
  }

 private:
  static Taylor Line(double s, double y, double slope, double integral) {
    return {integral + s * (y + s * slope / 2), y + s * slope, slope, 0, 0};
  }

  const std::vector<double>& x_;
  const std::vector<double>& y_;
  std::vector<double> slopes_;
  std::vector<double> integrals_;  // from the first point to each
};

// Three-point slope at an end that does not turn the curve around.
double EndSlope(double h0, double h1, double rise0, double rise1) {
  const double slope = ((2 * h0 + h1) * rise0 - h0 * rise1) / (h0 + h1);
  if (slope * rise0 <= 0) return 0;
  if (rise0 * rise1 <= 0 && std::abs(slope) > 3 * std::abs(rise0)) return 3 * rise0;
  return slope;
}

// Fritsch, Butland 1984, eq 5: weighted harmonic means, 0 where the points turn.
std::vector<double> MonotoneSlopes(const std::vector<double>& x, const std::vector<double>& y) {
  const std::size_t n = x.size();
  std::vector<double> step;
  std::vector<double> rise;
  for (std::size_t i = 0; i + 1 < n; ++i) {
    step.push_back(x[i + 1] - x[i]);
    rise.push_back((y[i + 1] - y[i]) / step.back());
  }
  if (n == 2) return {rise[0], rise[0]};
  std::vector<double> slopes(n, 0);
  for (std::size_t i = 1; i + 1 < n; ++i) {
    if (rise[i - 1] * rise[i] <= 0) continue;
    const double left = 2 * step[i] + step[i - 1];
    const double right = step[i] + 2 * step[i - 1];
    slopes[i] = (left + right) / (left / rise[i - 1] + right / rise[i]);
  }
  slopes.front() = EndSlope(step[0], step[1], rise[0], rise[1]);
  slopes.back() = EndSlope(step[n - 2], step[n - 3], rise[n - 2], rise[n - 3]);
  return slopes;
}

double OwnWindow(const std::vector<double>& x, const std::vector<double>& y) {
  std::vector<double> steps;
  for (std::size_t i = 0; i + 1 < x.size(); ++i) {
    if (y[i] != y[i + 1]) steps.push_back(x[i + 1] - x[i]);
  }
  if (steps.empty()) return 0.5 * (x[1] - x[0]);
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  return 0.5 * *middle;
}

}  // namespace

Result<MuscleCurve> MuscleCurve::Natural(const std::vector<double>& x, const std::vector<double>& y) {
  auto spline = NaturalCubicSpline::Fit(x, y);
  if (!spline) return Fail("curve of a muscle: {}", spline.error().message);
  const auto first = spline->At(x.front());
  std::vector<Piece> pieces{{x.front(), {first.value, first.first, 0, 0, 0}}};
  for (std::size_t i = 0; i + 1 < x.size(); ++i) {
    const auto here = spline->At(x[i]);
    const double third = (spline->At(x[i + 1]).second - here.second) / (x[i + 1] - x[i]);
    pieces.push_back({x[i], {here.value, here.first, here.second / 2, third / 6, 0}});
  }
  const auto last = spline->At(x.back());
  pieces.push_back({x.back(), {last.value, last.first, 0, 0, 0}});
  return MuscleCurve(std::move(pieces));
}

// The average of a polynomial of degree 3 over a window that slides across a break is one of degree 4; its
// derivatives are differences of the polynomials' at both ends of the window.
Result<MuscleCurve> MuscleCurve::Smooth(const std::vector<double>& x, const std::vector<double>& y,
                                        double window) {
  if (const auto valid = NaturalCubicSpline::Fit(x, y); !valid)
    return Fail("curve of a muscle: {}", valid.error().message);
  if (!(window >= 0) || !std::isfinite(window))
    return Fail("curve of a muscle: window {}, expected at least 0", window);
  if (window == 0) window = OwnWindow(x, y);
  const Hermite through(x, y, MonotoneSlopes(x, y));
  std::vector<double> breaks;
  for (const double knot : x) {
    breaks.push_back(knot - window / 2);
    breaks.push_back(knot + window / 2);
  }
  std::sort(breaks.begin(), breaks.end());
  breaks.erase(std::unique(breaks.begin(), breaks.end()), breaks.end());
  const Hermite::Taylor start = through.At(breaks.front() - window);
  std::vector<Piece> pieces{{breaks.front(), {start.value + start.first * window, start.first, 0, 0, 0}}};
  for (std::size_t i = 0; i + 1 < breaks.size(); ++i) {
    // The ends of the window lie on breaks of the curve: slightly inside, each is on the intended piece.
    const double inside = breaks[i] + 1e-6 * (breaks[i + 1] - breaks[i]);
    const double back = inside - breaks[i];
    const auto right = through.At(inside + window / 2);
    const auto left = through.At(inside - window / 2);
    std::array<double, 5> at{(right.integral - left.integral) / window, (right.value - left.value) / window,
                             (right.first - left.first) / window / 2,
                             (right.second - left.second) / window / 6,
                             (right.third - left.third) / window / 24};
    // Taylor coefficients at the break from those inside.
    for (std::size_t low = 0; low < 4; ++low) {
      for (std::size_t k = 4; k-- > low;) at[k] -= back * at[k + 1];
    }
    pieces.push_back({breaks[i], at});
  }
  const Hermite::Taylor end = through.At(breaks.back());
  pieces.push_back({breaks.back(), {end.value, end.first, 0, 0, 0}});
  return MuscleCurve(std::move(pieces));
}

}  // namespace sinew
