#include "identify/solvers/displacement.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "identify/solvers/multistart.h"

namespace sinew::solvers {
namespace {

constexpr double kDisplacement = 0.1;
constexpr double kDisplacementSpread = 1;  // of its logarithm

}  // namespace

StartSampler::StartSampler(const LeastSquares& fit) {
  const FitSetup& setup = fit.setup();
  for (int v = 0; v < fit.variables(); ++v) {
    const auto index = static_cast<std::size_t>(setup.free[static_cast<std::size_t>(v)]);
    if (setup.parameters[index].kind != ParameterKind::kNuisance) moving_.push_back(v);
  }
  if (!moving_.empty()) return;
  moving_.resize(static_cast<std::size_t>(fit.variables()));
  std::iota(moving_.begin(), moving_.end(), 0);
}

Vector StartSampler::Near(const Vector& x, Random& random) const {
  Vector y = x;
  const double size = kDisplacement * std::exp(kDisplacementSpread * random.Normal());
  for (const int v : moving_) {
    double value = std::abs(x[v] + size * random.Normal());
    if (value > 1) value = 2 - value;
    y[v] = std::clamp(value, 0.0, 1.0);
  }
  return y;
}

std::vector<Vector> StartSampler::Anywhere(const Vector& x, int count, std::uint64_t seed) const {
  std::vector<Vector> starts(static_cast<std::size_t>(count), x);
  const std::vector<Vector> points = LatinHypercube(count, static_cast<int>(moving_.size()), seed);
  for (std::size_t i = 0; i < starts.size(); ++i) {
    for (std::size_t k = 0; k < moving_.size(); ++k)
      starts[i][moving_[k]] = points[i][static_cast<Eigen::Index>(k)];
  }
  return starts;
}

}  // namespace sinew::solvers
