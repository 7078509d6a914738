#include "identify/noise/quasi_newton.h"

#include <algorithm>
#include <cmath>

namespace sinew::noise {
namespace {

constexpr double kDifference =
    1e-4;                           // truncation error: step^2 times a third derivative, far below the noise
constexpr double kLongestStep = 1;  // of any variable in one iteration
constexpr double kSufficient = 1e-4;  // share of the predicted decrease that a step must bring
constexpr int kMaxIterations = 100;
constexpr int kMaxHalvings = 30;

Vector Gradient(const std::function<double(const Vector&)>& function, Vector x) {
  Vector gradient(x.size());
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    const double middle = x[i];
    x[i] = middle + kDifference;
    const double above = function(x);
    x[i] = middle - kDifference;
    gradient[i] = (above - function(x)) / (2 * kDifference);
    x[i] = middle;
  }
  return gradient;
}

}  // namespace

double MinimizeSmooth(const std::function<double(const Vector&)>& function, const Vector& curvature,
                      double tolerance, Vector& x) {
  double value = function(x);
  if (x.size() == 0) return value;
  const Matrix first = curvature.cwiseInverse().asDiagonal();
  Matrix inverse = first;
  Vector gradient = Gradient(function, x);
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
      next = function(tried);
      if (next <= value + kSufficient * length * slope) break;
    }
    if (halvings == kMaxHalvings) {
      if (fresh) break;
      inverse = first;
      fresh = true;
      continue;
    }
    const Vector moved = tried - x;
    const Vector new_gradient = Gradient(function, tried);
    const Vector change = new_gradient - gradient;
    const double along = moved.dot(change);
    x = tried;
    value = next;
    gradient = new_gradient;
    fresh = false;
    if (!(along > 1e-10 * moved.norm() * change.norm())) continue;  // no positive curvature seen
    const Vector image = inverse * change;
    inverse += (1 + change.dot(image) / along) / along * moved * moved.transpose() -
               (image * moved.transpose() + moved * image.transpose()) / along;
  }
  return value;
}

}  // namespace sinew::noise
