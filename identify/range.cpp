#include "identify/range.h"

#include <algorithm>
#include <cmath>

namespace sinew {
namespace {

constexpr double kSlack = 0.01;  // of the width: how far the smooth bound may exceed the largest distance

// Positive above the range, negative below it.
double Outside(const Range& range, double value) {
  return std::max(value - range.upper, 0.0) + std::min(value - range.lower, 0.0);
}

}  // namespace

double DistanceFrom(const Range& range, const Eigen::Ref<const Vector>& values, Vector* slopes) {
  double squares = 0;
  for (const double value : values) squares += std::pow(Outside(range, value), 2);
  const double distance = std::sqrt(squares);
  if (slopes == nullptr) return distance;
  slopes->setZero(values.size());
  if (distance == 0) return distance;
  for (Eigen::Index i = 0; i < values.size(); ++i) (*slopes)[i] = Outside(range, values[i]) / distance;
  return distance;
}

double FarthestFrom(const Range& range, const Eigen::Ref<const Vector>& values, Vector* slopes) {
  const double farthest = std::max(values.maxCoeff() - range.upper, range.lower - values.minCoeff());
  const double terms = 2 * static_cast<double>(values.size());
  const double sharpness = std::log(terms) / (kSlack * (range.upper - range.lower));
  if (slopes != nullptr) slopes->resize(values.size());
  double sum = 0;
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    const double above = std::exp(sharpness * (values[i] - range.upper - farthest));
    const double below = std::exp(sharpness * (range.lower - values[i] - farthest));
    sum += above + below;
    if (slopes != nullptr) (*slopes)[i] = above - below;
  }
  if (slopes != nullptr) *slopes /= sum;
  return farthest + std::log(sum) / sharpness;
}

}  // namespace sinew
