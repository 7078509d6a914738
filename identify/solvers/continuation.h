// Solver `continuation`: local searches at noise levels that fall to the stated ones in stages.
#pragma once

#include <limits>

#include "identify/solvers/solver.h"

namespace sinew::solvers {

/// The noise levels of such a search, as weights of the data: the stated level over that of a stage.
struct NoiseSchedule {
  double first_weight = 0;  ///< of the first stage; 0: that at which the data's mean squared residual is 1
  double ratio = 0;         ///< of successive weights; 0: what the misfit asks for, between 1.4 and 3
  /// The search is given up where a stage costs more: the cost of a minimum grows with the weight, so that
  /// this one ends higher still.
  double most_cost = std::numeric_limits<double>::infinity();
};

/// Levenberg-Marquardt for fits in which hundreds of nuisance values with a prior follow precise data, such
/// as the deviations of a recorded motion: from a start whose misfit is many noise levels a search at these
/// levels bends the curves to fit the largest residuals first, and ends in a minimum far away. At noise
/// levels as large as the misfit the priors hold the curves, and the minimum is found; it is the start of a
/// search at lower levels, until they are the stated ones. By default each level is that at which the data's
/// mean squared residual would be 1, but at least 1.4 and at most 3 times lower than the one before.
///
/// Without priors levels do not matter: then, and where the start already fits, this is `lm`.
/// Sources: Blake, Zisserman (1987), Visual Reconstruction, ch. 7; Allgower, Georg (1990), Numerical
/// Continuation Methods.
class Continuation : public Solver {
 public:
  explicit Continuation(double cost_tolerance, double first_damping = 1e-8,
                        const NoiseSchedule& schedule = {})
      : cost_tolerance_(cost_tolerance), first_damping_(first_damping), schedule_(schedule) {}

 private:
  Search DoSolve(Evaluator& evaluator, const Vector& start) const override;

  double cost_tolerance_;
  double first_damping_;
  NoiseSchedule schedule_;
};

}  // namespace sinew::solvers
