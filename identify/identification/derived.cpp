#include "identify/identification/derived.h"

#include <algorithm>
#include <cmath>

namespace sinew {
namespace {

// What a parameter's interval contributes to one side of that of the quantity.
struct Contribution {
  Eigen::Index verdict = 0;  // index into Uncertainty::parameters
  double amount = 0;         // >= 0
  double sign = 1;           // of the parameter's change
};

double Combined(const std::vector<Contribution>& parts, const Matrix& correlation) {
  double square = 0;
  for (const Contribution& a : parts) {
    for (const Contribution& b : parts) {
      const bool known = a.verdict < correlation.rows() && b.verdict < correlation.cols() &&
                         std::isfinite(correlation(a.verdict, b.verdict));
      const double together = a.verdict == b.verdict ? 1 : known ? correlation(a.verdict, b.verdict) : 0;
      square += together * a.sign * b.sign * a.amount * b.amount;
    }
  }
  return std::sqrt(std::max(0.0, square));
}

void AddInterval(const DerivedQuantity& quantity, const FitSetup& setup, const Vector& parameters,
                 const Uncertainty& uncertainty, DerivedResult& result) {
  std::vector<Contribution> down;
  std::vector<Contribution> up;
  for (const int index : quantity.parameters) {
    if (!setup.IsFree(index)) continue;
    const auto& all = uncertainty.parameters;
    const auto found =
        std::find_if(all.begin(), all.end(), [&](const auto& v) { return v.parameter == index; });
    if (found == all.end() || found->interval == IntervalKind::kNone) return;
    const double here = parameters[index];
    if (here < found->ci95_lower || here > found->ci95_upper) return;
    for (const double end : {found->ci95_lower, found->ci95_upper}) {
      Vector at = parameters;
      at[index] = end;
      const double change = quantity.value(at) - result.value;
      if (!std::isfinite(change)) return;
      (change < 0 ? down : up)
          .push_back(
              {static_cast<Eigen::Index>(found - all.begin()), std::abs(change), end < here ? -1.0 : 1.0});
    }
  }
  result.interval = true;
  result.ci95_lower = result.value - Combined(down, uncertainty.correlation);
  result.ci95_upper = result.value + Combined(up, uncertainty.correlation);
}

}  // namespace

std::vector<DerivedResult> DeriveResults(const Problem& problem, const FitSetup& setup,
                                         const Vector& parameters, const Uncertainty& uncertainty) {
  std::vector<DerivedResult> results;
  for (const DerivedQuantity& quantity : problem.DerivedQuantities()) {
    DerivedResult result{quantity.name, quantity.unit, quantity.meaning, {}, quantity.value(parameters)};
    for (const int index : quantity.parameters) {
      if (setup.IsFree(index)) result.from.push_back(setup.parameters[static_cast<std::size_t>(index)].name);
    }
    if (result.from.empty()) continue;
    AddInterval(quantity, setup, parameters, uncertainty, result);
    results.push_back(std::move(result));
  }
  return results;
}

}  // namespace sinew
