// Solver `sa`: simulated annealing, the thesis's method for contact parameters.
#pragma once

#include <optional>

#include "identify/solvers/annealing.h"
#include "identify/solvers/solver.h"

namespace sinew {

/// Cools over the box [0, 1]^n with the algorithm of annealing.h.
///
/// The temperature at the start, unless set, is the median rise of cost from the best to the others among a
/// few random points: moves across the box are then accepted about as often as not. The schedule is the
/// published one (NS 20, NT max(100, 5 n), RT 0.85) when the budget allows for it; a smaller budget first
/// lowers NT, then cools faster, then lowers NS, so that the temperature falls by the same 1e-6 in any case.
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

/// The schedule for n variables and a number of moves (any large number if there is no limit); its
/// temperature is left open.
[[nodiscard]] AnnealingSchedule ScheduleFor(int variables, long moves);

}  // namespace sinew
