#include "identify/diagnosis/select/many_starts.h"

#include <algorithm>
#include <cmath>

namespace sinew::diagnosis {
namespace {

constexpr long kScoutEvaluations = 8;
constexpr long kFitEvaluations = 80;
constexpr double kSpreads[] = {0.8, 0.25, 0.08};
constexpr double kLeastStep = 0.02;  // of the range, for values near their null

// Anywhere in the range of an effect's parameter, uniform in the logarithm of its size.
double AnywhereOf(const Parameter& p, Random& random) {
  constexpr double kDecades = 2;
  const double share = std::pow(10, -kDecades * random.Uniform());
  const bool up = p.lower >= p.null_value || (p.upper > p.null_value && random.Uniform() < 0.5);
  return p.null_value + share * ((up ? p.upper : p.lower) - p.null_value);
}

}  // namespace

solvers::LocalFit::Outcome FitFromManyStarts(const LeastSquares& fit, const std::vector<Vector>& starts,
                                             double tolerance, std::size_t continued) {
  solvers::LocalFit search(fit);
  const auto lower_cost = [](const auto& a, const auto& b) { return a.cost < b.cost; };
  std::vector<solvers::LocalFit::Outcome> scouts;
  for (const Vector& start : starts)
    scouts.push_back(search.Minimize(fit.Variables(start), -1, {0, tolerance}, kScoutEvaluations));
  std::stable_sort(scouts.begin(), scouts.end(), lower_cost);
  scouts.resize(std::min(scouts.size(), continued));
  for (auto& scout : scouts) {
    if (!std::isfinite(scout.cost) || scout.converged) continue;
    auto further = search.Minimize(scout.x, -1, {0, tolerance}, kFitEvaluations);
    if (further.failure.empty() && further.cost <= scout.cost) scout = std::move(further);
  }
  return *std::min_element(scouts.begin(), scouts.end(), lower_cost);
}

Vector DrawStart(const FitSetup& setup, const Vector& point, int turn, Random& random) {
  const double spread = kSpreads[static_cast<std::size_t>(turn) / 2 % std::size(kSpreads)];
  Vector start = point;
  for (const int index : setup.free) {
    const Parameter& p = setup.parameters[static_cast<std::size_t>(index)];
    if (p.kind == ParameterKind::kNuisance) continue;
    if (p.kind == ParameterKind::kEffect && turn % 2 == 1) {
      start[index] = AnywhereOf(p, random);
    } else if (p.scale == Scale::kLog) {
      start[index] *= std::exp(spread * random.Normal());
    } else {
      const double size = std::max(std::abs(start[index] - p.null_value), kLeastStep * (p.upper - p.lower));
      start[index] += spread * size * random.Normal();
    }
    start[index] = std::clamp(start[index], p.lower, p.upper);
  }
  return start;
}

Vector DrawEffects(const FitSetup& setup, const Vector& point, Random& random) {
  Vector start = point;
  for (const int index : setup.free) {
    const Parameter& p = setup.parameters[static_cast<std::size_t>(index)];
    if (p.kind == ParameterKind::kEffect) start[index] = AnywhereOf(p, random);
  }
  return start;
}

}  // namespace sinew::diagnosis
