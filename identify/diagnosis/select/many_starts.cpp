#include "identify/diagnosis/select/many_starts.h"

#include <algorithm>
#include <cmath>
#include <utility>

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

bool LowerCost(const solvers::LocalFit::Outcome& a, const solvers::LocalFit::Outcome& b) {
  return a.cost < b.cost;
}

}  // namespace

ManyStarts::ManyStarts(const LeastSquares& fit, const std::vector<Vector>& starts, double tolerance,
                       std::size_t continued)
    : fit_(fit), tolerance_(tolerance), continued_(continued) {
  for (const Vector& start : starts) {
    found_.emplace_back();
    found_.back().x = fit.Variables(start);
  }
  solvers::LocalFit probe(fit);
  for (std::size_t i = 0; fit.constraints() > 0 && penalty_ == 0 && i < found_.size(); ++i) {
    if (probe.ModelAt(found_[i].x)) penalty_ = probe.penalty();
  }
}

void ManyStarts::Search(std::size_t start) {
  solvers::LocalFit search(fit_, penalty_);
  found_[start] = search.Minimize(found_[start].x, -1, {0, tolerance_}, kScoutEvaluations);
}

void ManyStarts::Shorten() {
  std::stable_sort(found_.begin(), found_.end(), LowerCost);
  found_.resize(std::min(found_.size(), continued_));
}

void ManyStarts::Continue(std::size_t one) {
  solvers::LocalFit::Outcome& found = found_[one];
  if (!std::isfinite(found.cost) || found.converged) return;
  solvers::LocalFit search(fit_, penalty_);
  auto further = search.Minimize(found.x, -1, {0, tolerance_}, kFitEvaluations);
  if (further.failure.empty() && further.cost <= found.cost) found = std::move(further);
}

const solvers::LocalFit::Outcome& ManyStarts::Best() const {
  return *std::min_element(found_.begin(), found_.end(), LowerCost);
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
