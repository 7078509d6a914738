#include "models/muscle/elastic_tendon.h"

#include <algorithm>

namespace sinew {
namespace {

constexpr int kMaxIterations = 100;
constexpr double kTolerance = 1e-14;  // of the optimal length
constexpr double kSlack = 0.5;        // optimal lengths by which the tendon hangs, at first
constexpr double kMaxSlack = 64;

}  // namespace

// The imbalance is negative for a short fibre, whose tendon is taut, and positive for a long one.
Result<double> EquilibriumLength(const MuscleCurves& curves, const HillMuscle<double>& muscle,
                                 double unit_length, double activation, const FibreVelocity<double>& velocity,
                                 double guess) {
  const auto dual = elastic_tendon::Plain<Dual<1>>(muscle);
  const auto at = [&](double length) {
    const Dual<1> moving = Dual<1>::Variable(length, 0);
    return elastic_tendon::Imbalance(curves, dual, unit_length, moving,
                                     velocity.rate * moving + velocity.past, Dual<1>(activation));
  };
  const double optimal = muscle.optimal_length;
  double low = kShortestFibre * optimal;
  const double rigid = RigidFibreLength(muscle, unit_length);
  double high = std::max(rigid, low) + kSlack * optimal;
  Dual<1> imbalance = at(high);
  for (double slack = 2 * kSlack; !(imbalance.value >= 0) && slack <= kMaxSlack; slack *= 2) {
    low = high;
    high = std::max(rigid, low) + slack * optimal;
    imbalance = at(high);
  }
  if (!(imbalance.value >= 0) || (low == kShortestFibre * optimal && !(at(low).value <= 0))) {
    return Fail(
        "fibre and tendon find no equilibrium: unit of {:.4g} m, optimal fibre length {:.4g} m, tendon slack "
        "length {:.4g} m, activation {:.3g}",
        unit_length, optimal, muscle.tendon_slack_length, activation);
  }
  double length = guess > low && guess < high ? guess : std::clamp(rigid, low, high);
  for (int i = 0; i < kMaxIterations; ++i) {
    imbalance = at(length);
    (imbalance.value < 0 ? low : high) = length;
    double next = length - imbalance.value / imbalance.d[0];
    if (!(next > low && next < high)) next = 0.5 * (low + high);
    const double step = std::abs(next - length);
    length = next;
    if (step <= kTolerance * optimal || high - low <= kTolerance * optimal) break;
  }
  return length;
}

}  // namespace sinew
