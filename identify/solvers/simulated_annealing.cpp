#include "identify/solvers/simulated_annealing.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/median.h"
#include "base/random.h"
#include "identify/solvers/objective.h"

namespace sinew::solvers {
namespace {

// Total factor of the temperature: from moves across the box to steps of a thousandth of it, as the cost
// grows with the square of the step.
constexpr double kTemperatureFall = 1e-6;
constexpr int kMinTemperatures = 20;
constexpr int kMinCycles = 2;
// One random point for the start temperature per this many evaluations of the budget, within the limits
// below.
constexpr long kBudgetPerProbe = 20;
constexpr long kMinProbes = 3;
constexpr long kMaxProbes = 10;
// Tolerance of the final costs: this times the best cost; for data without noise, whose best cost is zero,
// this times the first temperature.
constexpr double kRelativeAgreement = 1e-6;
constexpr double kAgreementOfFirstTemperature = 1e-12;

// Median rise from the best to the other finite costs; 1 if they do not differ.
double TemperatureFrom(const std::vector<double>& costs) {
  if (costs.size() < 2) return 1;
  const double best = *std::min_element(costs.begin(), costs.end());
  std::vector<double> rises;
  for (const double cost : costs) {
    if (cost > best) rises.push_back(cost - best);
  }
  return rises.empty() ? 1 : UpperMedian(rises);
}

}  // namespace

AnnealingSchedule ScheduleFor(int variables, long moves) {
  AnnealingSchedule schedule;
  const long n = variables;
  const long most_adjustments = std::max(100L, 5 * n);
  const auto temperatures = std::lround(std::log(kTemperatureFall) / std::log(schedule.cooling));
  const long moves_per_adjustment = n * schedule.cycles;

  const long adjustments = moves / (temperatures * moves_per_adjustment);
  schedule.adjustments = static_cast<int>(std::clamp(adjustments, 1L, most_adjustments));
  if (adjustments >= 1) return schedule;

  const long affordable = std::max<long>(moves / moves_per_adjustment, kMinTemperatures);
  schedule.cooling = std::pow(kTemperatureFall, 1.0 / static_cast<double>(affordable));
  const long cycles = moves / (n * affordable);
  schedule.cycles = static_cast<int>(std::clamp<long>(cycles, kMinCycles, schedule.cycles));
  return schedule;
}

Search SimulatedAnnealing::DoSolve(Evaluator& evaluator, const Vector& start) const {
  Random random(seed_);
  Objective objective(evaluator);
  const long budget = evaluator.remaining().max_evaluations;
  const Eigen::Index n = start.size();

  std::vector<double> costs;
  const double start_cost = objective.Cost(start);
  if (std::isfinite(start_cost)) costs.push_back(start_cost);
  Vector x(n);
  const long probes = start_temperature_ ? 0 : std::clamp(budget / kBudgetPerProbe, kMinProbes, kMaxProbes);
  for (long i = 0; i < probes; ++i) {
    for (double& value : x) value = random.Uniform();
    const double cost = objective.Cost(x);
    if (objective.stopped()) return {};
    if (std::isfinite(cost)) costs.push_back(cost);
  }

  AnnealingSchedule schedule = ScheduleFor(static_cast<int>(n), evaluator.remaining().max_evaluations);
  schedule.temperature = start_temperature_.value_or(TemperatureFrom(costs));
  schedule.tolerance = kAgreementOfFirstTemperature * schedule.temperature;
  schedule.relative_tolerance = kRelativeAgreement;
  schedule.step = Vector::Ones(n);

  // The search begins at the best point so far, which may be one of the random ones.
  const bool has_best = evaluator.has_best();
  const Vector first = has_best ? evaluator.best().x : start;
  const double first_cost = has_best ? evaluator.best().cost : std::numeric_limits<double>::infinity();
  const AnnealingCost cost = [&objective](const Vector& at, double& value) {
    value = objective.Cost(at);
    return !objective.stopped();
  };
  const AnnealingResult result = Anneal(cost, Vector::Zero(n), Vector::Ones(n), first, first_cost, schedule,
                                        [&random] { return random.Uniform(); });
  return {{Termination::kAnnealed,
           fmt::format("last costs at {} temperatures agree within {:.3g} <= {:.3g}, temperature {:.3g}",
                       schedule.final_costs, result.spread,
                       schedule.tolerance + schedule.relative_tolerance * std::abs(result.cost),
                       result.temperature)},
          result.temperatures,
          {}};
}

}  // namespace sinew::solvers
