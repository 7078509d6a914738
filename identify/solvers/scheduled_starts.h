// Solver `restarts` where nuisance parameters have priors: searches under different schedules of the noise.
#pragma once

#include <functional>
#include <vector>

#include "base/random.h"
#include "identify/solvers/displacement.h"
#include "identify/solvers/solver.h"

namespace sinew::solvers {

/// Which minimum a search ends in is decided less by where it begins than by how the data's weight grows: so
/// the starts are searches by `continuation` with different schedules, first from the given start, then from
/// starts near it.
///
/// 1. Two schedules; where trials have curves, up to eight while none ends near a cost of noise
/// (NearNoiseCost).
///    From the third on one whose cost exceeds that of the best end is given up. Two of the eight, and two
///    more of sixteen, begin where a search with priors about the start ends (RegularisedStart).
/// 2. The best end is improved: stretches of single trials are redrawn (SearchTrials), all values searched
///    from there, then stretches are redrawn with all values free (RedrawTrials), until these bring little.
///    Where much more than noise is left, trials are searched in growing windows, too. Then the next best
///    end, until two are at the same minimum, three where much more than noise is left. Without curves
///    (HasCurves) an end is as good as it gets.
/// 3. Where none is left to be improved, further schedules: up to eight in all, sixteen where more than noise
///    is left.
///
/// Ends are ranked by MarginalCost; of those within kSameEvidence of the best one the lowest cost counts. The
/// best end is the start of one local search without a limit. The stages are the ends, best first. What is
/// evaluated does not depend on the number of threads. Searches of trials and redrawn stretches are not
/// counted as evaluations.
class ScheduledStarts {
 public:
  ScheduledStarts(Evaluator& evaluator, const SolverOptions& options);

  [[nodiscard]] Search Run(const Vector& start);

 private:
  struct End {
    Stage stage;
    double marginal = 0;
    bool given_up = false;
    bool improved = false;
  };

  void Attempt(std::size_t which, const Vector& start);
  // Where a search with priors on all parameters ends.
  [[nodiscard]] Vector Regularised(std::size_t which, const Vector& start) const;
  [[nodiscard]] End* NextToImprove();
  void Improve(End& end);
  void ImproveTrials(End& end, bool in_windows);
  void Redraw(End& end, int round);
  void Take(End& end, const Vector& x);
  // Whether the end gained enough to go on.
  [[nodiscard]] static bool Gains(const End& end, const std::function<void()>& improve);
  [[nodiscard]] Stage Polish(const Solver& solver, const std::string& name, const Vector& x,
                             long evaluations);
  [[nodiscard]] End* Best();
  [[nodiscard]] static bool Agree(const End& a, const End& b);
  // Whether an end is at the minimum of the best one, or of another improved one if it is the best itself.
  [[nodiscard]] bool Confirms(const End& end);
  [[nodiscard]] int Agreeing();
  [[nodiscard]] bool Agrees();
  [[nodiscard]] double NoiseCost() const;
  [[nodiscard]] bool LeavesNoise();
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
