// Solver `restarts` where nuisance parameters have priors: searches under different schedules of the noise.
#pragma once

#include <vector>

#include "base/random.h"
#include "identify/solvers/displacement.h"
#include "identify/solvers/solver.h"

namespace sinew::solvers {

/// Which minimum a search ends in is decided less by where it begins than by how the data's weight grows: so
/// the starts are searches by `continuation` with different schedules, first from the given start, then from
/// starts near it.
///
/// 1. Two schedules. Where they end at the same minimum, and its cost is one of noise (at most half the
/// number
///    of data rows), this is the answer.
/// 2. Else every trial's own values are searched in growing windows (SearchTrials), all values from there,
///    and so on while that helps; then by further schedules, each given up when its cost exceeds that of the
///    best end, until two schedules end at the same minimum or eight are done; three and sixteen, where the
///    best end leaves more than noise.
///
/// Ends are ranked by MarginalCost; of those within kSameEvidence of the best one the lowest cost counts. The
/// best end is the start of one local search without a limit. The stages are the ends, best first. What is
/// evaluated does not depend on the number of threads. Windows are not counted as evaluations.
class ScheduledStarts {
 public:
  ScheduledStarts(Evaluator& evaluator, const SolverOptions& options);

  [[nodiscard]] Search Run(const Vector& start);

 private:
  struct End {
    Stage stage;
    double marginal = 0;
    bool given_up = false;
  };

  void Attempt(std::size_t which, const Vector& start);
  void ImproveTrials(End& end);
  [[nodiscard]] Stage Polish(const Solver& solver, const std::string& name, const Vector& x,
                             long evaluations);
  [[nodiscard]] const End* Best() const;
  [[nodiscard]] int Agreeing() const;
  [[nodiscard]] bool Agrees() const;
  [[nodiscard]] bool LeavesNoise() const;
  [[nodiscard]] bool Done();
  Search Finish();

  Evaluator& evaluator_;
  const SolverOptions& options_;
  StartSampler sampler_;
  Random random_;
  std::vector<End> ends_;
  Search search_;
};

/// Difference of two MarginalCosts that does not decide between two minima: along one valley, between points
/// whose costs hardly differ, it varies by up to ten.
inline constexpr double kSameEvidence = 20;

/// Difference of two costs, which are logarithms of densities, that are taken for the same minimum.
inline constexpr double kSamePosterior = 0.25;

}  // namespace sinew::solvers
