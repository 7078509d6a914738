#include "base/quintic_spline.h"

#include <algorithm>

#include "base/linear_algebra.h"
#include "base/spline.h"

namespace sinew {
namespace {

using Pair = Eigen::Vector2d;    // first and second derivative at a sample
using Square = Eigen::Matrix2d;  // third and fourth derivative at an end of an interval, per such a pair

// Third and fourth derivative at one end of an interval of length h: constant + own * (derivatives there) +
// other * (derivatives at the other end). From the polynomial of degree 5 with these values at both ends.
struct EndOfInterval {
  Pair constant;
  Square own;
  Square other;
};

EndOfInterval AtBegin(double h, double rise) {
  EndOfInterval at;
  at.constant << 60 * rise / (h * h * h), -360 * rise / (h * h * h * h);
  at.own << -36 / (h * h), -9 / h, 192 / (h * h * h), 36 / (h * h);
  at.other << -24 / (h * h), 3 / h, 168 / (h * h * h), -24 / (h * h);
  return at;
}

// The same seen from the other end: time runs backwards, odd derivatives change their signs.
EndOfInterval AtEnd(double h, double rise) {
  EndOfInterval at = AtBegin(h, -rise);
  at.constant[0] = -at.constant[0];
  for (Square* slopes : {&at.own, &at.other}) {
    (*slopes)(0, 1) = -(*slopes)(0, 1);
    (*slopes)(1, 0) = -(*slopes)(1, 0);
  }
  return at;
}

}  // namespace

Result<NaturalQuinticSpline> NaturalQuinticSpline::Fit(std::vector<double> time, std::vector<double> values) {
  SINEW_TRY(CheckSplineSamples(time, values, 3));
  const std::size_t n = time.size();

  // Third and fourth derivatives agree at every inner sample, and are zero at the ends: a block tridiagonal
  // system, in units of the mean distance of the samples.
  const double unit = (time.back() - time.front()) / static_cast<double>(n - 1);
  std::vector<Square> upper(n, Square::Zero());
  std::vector<Pair> derivatives(n, Pair::Zero());
  for (std::size_t i = 0; i < n; ++i) {
    Square diagonal = Square::Zero();
    Pair right = Pair::Zero();
    if (i > 0) {
      const EndOfInterval left = AtEnd((time[i] - time[i - 1]) / unit, values[i] - values[i - 1]);
      diagonal += left.own - left.other * upper[i - 1];
      right -= left.constant + left.other * derivatives[i - 1];
    }
    Square next = Square::Zero();
    if (i + 1 < n) {
      const EndOfInterval begin = AtBegin((time[i + 1] - time[i]) / unit, values[i + 1] - values[i]);
      diagonal -= begin.own;
      next = -begin.other;
      right += begin.constant;
    }
    Square inverse;
    inverse << diagonal(1, 1), -diagonal(0, 1), -diagonal(1, 0), diagonal(0, 0);
    inverse /= diagonal(0, 0) * diagonal(1, 1) - diagonal(0, 1) * diagonal(1, 0);
    upper[i] = inverse * next;
    derivatives[i] = inverse * right;
  }
  for (std::size_t i = n - 1; i-- > 0;) derivatives[i] -= upper[i] * derivatives[i + 1];

  NaturalQuinticSpline spline;
  spline.time_ = std::move(time);
  for (std::size_t i = 0; i < n; ++i)
    spline.samples_.push_back({values[i], derivatives[i][0] / unit, derivatives[i][1] / (unit * unit)});
  return spline;
}

NaturalQuinticSpline::Value NaturalQuinticSpline::At(double t) const {
  if (t < time_.front() || t > time_.back()) {
    const Value& end = t < time_.front() ? samples_.front() : samples_.back();
    const double away = t - (t < time_.front() ? time_.front() : time_.back());
    return {end.value + away * (end.first + away * end.second / 2), end.first + away * end.second,
            end.second};
  }
  const auto after = std::upper_bound(time_.begin() + 1, time_.end() - 1, t);
  const auto j = static_cast<std::size_t>(after - time_.begin());
  const Value& a = samples_[j - 1];
  const Value& b = samples_[j];
  const double h = time_[j] - time_[j - 1];
  // What is left at the end of the interval of a parabola from its begin: the higher powers.
  const double value = b.value - (a.value + h * (a.first + h * a.second / 2));
  const double first = h * (b.first - (a.first + h * a.second));
  const double second = h * h * (b.second - a.second);
  const double third = 10 * value - 4 * first + second / 2;
  const double fourth = -15 * value + 7 * first - second;
  const double fifth = 6 * value - 3 * first + second / 2;
  const double s = (t - time_[j - 1]) / h;
  return {a.value + h * s * (a.first + h * s * a.second / 2) + s * s * s * (third + s * (fourth + s * fifth)),
          a.first + h * s * a.second + s * s * (3 * third + s * (4 * fourth + s * 5 * fifth)) / h,
          a.second + s * (6 * third + s * (12 * fourth + s * 20 * fifth)) / (h * h)};
}

}  // namespace sinew
