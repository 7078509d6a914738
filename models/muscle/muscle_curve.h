// A normalised curve of a muscle or tendon as data: points, and a smooth way through them.
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

#include "base/dual.h"
#include "base/error.h"

namespace sinew {

/// Polynomials of degree 4 or less between breaks, twice continuously differentiable; the end slopes go on
/// for ever.
class MuscleCurve {
 public:
  struct Point {
    double value = 0;
    double slope = 0;
    double curvature = 0;
  };

  /// The natural cubic spline through the points: what CEINMS makes of its curves. It overshoots beside a
  /// bend, by up to 0.01 for the curves that come with CEINMS.
  /// @param x, y [N >= 2], x increasing. Errors: sizes differ, too few, x does not increase, not finite.
  static Result<MuscleCurve> Natural(const std::vector<double>& x, const std::vector<double>& y);

  /// The monotone cubic through the points (Fritsch, Butland 1984), averaged over a window: it rises where
  /// the points rise and nowhere else. Corners are rounded within half of the window; between them the curve
  /// keeps to the points within a few thousandths.
  /// @param window [unit of x, > 0]; 0: half of the median distance between points that differ in height.
  /// Errors: as Natural; a negative window.
  static Result<MuscleCurve> Smooth(const std::vector<double>& x, const std::vector<double>& y,
                                    double window = 0);

  [[nodiscard]] Point At(double x) const {
    // The last piece that begins at or before x, by bisection without branches that depend on x.
    std::size_t at = 0;
    for (std::size_t count = begins_.size(); count > 1;) {
      const std::size_t half = count / 2;
      at += begins_[at + half] <= x ? half : 0;
      count -= half;
    }
    const double s = x - pieces_[at].begin;
    const auto& c = pieces_[at].coefficients;
    return {c[0] + s * (c[1] + s * (c[2] + s * (c[3] + s * c[4]))),
            c[1] + s * (2 * c[2] + s * (3 * c[3] + s * 4 * c[4])), 2 * c[2] + s * (6 * c[3] + s * 12 * c[4])};
  }

  [[nodiscard]] double operator()(double x) const { return At(x).value; }
  template <int N>
  [[nodiscard]] Dual<N> operator()(const Dual<N>& x) const {
    const Point point = At(x.value);
    return Dual<N>::Chain(point.value, point.slope, x);
  }

 private:
  struct Piece {
    double begin = 0;
    std::array<double, 5> coefficients{};  // of powers of (x - begin), lowest first
  };
  explicit MuscleCurve(std::vector<Piece> pieces) : pieces_(std::move(pieces)) {
    for (const Piece& piece : pieces_) begins_.push_back(piece.begin);
    // The first two begin at the same place: the first is for what lies below.
    begins_.front() = -std::numeric_limits<double>::infinity();
  }

  std::vector<Piece> pieces_;  // the first is used below its begin too: it is a straight line, as is the last
  std::vector<double> begins_;
};

}  // namespace sinew
