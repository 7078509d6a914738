#include "identify/noise/quasi_newton.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace sinew::noise {
namespace {

constexpr double kLongestStep = 1;    // of any variable in one iteration
constexpr double kSufficient = 1e-4;  // share of the predicted decrease that a step must bring
constexpr int kMaxIterations = 100;
constexpr int kMaxHalvings = 30;

}  // namespace

double MinimizeSmooth(const SmoothFunction& function, const Vector& curvature, double tolerance, Vector& x) {
  if (x.size() == 0) return function(x, nullptr);
  // Where the function has no finite value, it sets no gradient.
  const auto gradient_at = [&](const Vector& at, double& value) {
    Vector gradient;
    value = function(at, &gradient);
    if (gradient.size() == at.size()) return gradient;
    return Vector(Vector::Constant(at.size(), std::numeric_limits<double>::quiet_NaN()));
  };
  double value = 0;
  Vector gradient = gradient_at(x, value);
  const Matrix first = curvature.cwiseInverse().asDiagonal();
  Matrix inverse = first;
  bool fresh = true;  // `inverse` is still the initial estimate
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    Vector step = -inverse * gradient;
    double slope = gradient.dot(step);
    if (!(slope < 0) || !step.allFinite()) {
      if (fresh) break;
      inverse = first;
      fresh = true;
      continue;
    }
    if (-0.5 * slope < tolerance) break;
    const double longest = step.cwiseAbs().maxCoeff();
    double length = std::min(1.0, kLongestStep / longest);
    double next = value;
    Vector tried;
    int halvings = 0;
    for (; halvings < kMaxHalvings; ++halvings, length *= 0.5) {
      tried = x + length * step;
      next = function(tried, nullptr);
      if (next <= value + kSufficient * length * slope) break;
    }
    if (halvings == kMaxHalvings) {
      if (fresh) break;
      inverse = first;
      fresh = true;
      continue;
    }
    const Vector moved = tried - x;
    double there = 0;
    Vector new_gradient = gradient_at(tried, there);
    const Vector change = new_gradient - gradient;
    const double along = moved.dot(change);
    x = tried;
    value = next;
    gradient = std::move(new_gradient);
    fresh = false;
    if (!(along > 1e-10 * moved.norm() * change.norm())) continue;  // no positive curvature seen
    const Vector image = inverse * change;
    inverse += (1 + change.dot(image) / along) / along * moved * moved.transpose() -
               (image * moved.transpose() + moved * image.transpose()) / along;
  }
  return value;
}

}  // namespace sinew::noise
