// Solver `sa`: simulated annealing, the thesis's method for contact parameters.
#pragma once

#include <optional>

#include "identify/solvers/annealing.h"
#include "identify/solvers/solver.h"

namespace sinew::solvers {

/// Simulated annealing over the box [0, 1]^n with the algorithm of annealing.h.
///
/// The start temperature, unless set, is the median rise of the cost from the best to the others among a few
/// random points, so that moves across the box are accepted about half of the time. The schedule is the
/// published one (NS 20, NT max(100, 5 n), RT 0.85) if the budget is large enough; a smaller budget first
/// lowers NT, then cools faster, then lowers NS, so that the temperature falls by the same factor of 1e-6 in
/// any case.
class SimulatedAnnealing : public Solver {
 public:
  explicit SimulatedAnnealing(std::uint64_t seed, std::optional<double> start_temperature = std::nullopt)
      : seed_(seed), start_temperature_(start_temperature) {}

  [[nodiscard]] bool ToleratesFailedStart() const override { return true; }

 private:
  Search DoSolve(Evaluator& evaluator, const Vector& start) const override;

  std::uint64_t seed_;
  std::optional<double> start_temperature_;
};

/// The schedule for n variables and a number of moves (any large number if there is no limit), without its
/// start temperature.
[[nodiscard]] AnnealingSchedule ScheduleFor(int variables, long moves);

}  // namespace sinew::solvers
