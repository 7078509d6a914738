// Simulated annealing over a box, after Corana et al. and Goffe, Ferrier, Rogers: the algorithm alone,
// without problems, budgets or a random generator.
#pragma once

#include <functional>

#include "base/linear_algebra.h"

namespace sinew::solvers {

/// Defaults are those of Corana et al. (1987). Names in brackets are those of the published program,
/// simann.f.
struct AnnealingSchedule {
  double temperature = 1;         ///< [T, unit of the cost] at the start, > 0
  double cooling = 0.85;          ///< [RT] factor of the temperature, within 0..1
  int cycles = 20;                ///< [NS] moves of every variable between two adjustments of the steps
  int adjustments = 100;          ///< [NT] adjustments before the temperature falls; published: max(100, 5 n)
  int final_costs = 4;            ///< [NEPS] temperatures whose last costs must agree at the end
  double tolerance = 1e-6;        ///< [EPS, unit of the cost] by which they may differ
  double relative_tolerance = 0;  ///< added to it: this times the best cost
  double step_control = 2;        ///< [C] how strongly steps follow the share of accepted moves
  Vector step;                    ///< [VM, n] first step lengths
};

struct AnnealingResult {
  Vector x;                ///< best point
  double cost = 0;         ///< there
  long moves = 0;          ///< cost evaluations; the start is not among them
  long accepted = 0;       ///< of these
  long out_of_bounds = 0;  ///< trial points outside the bounds that were replaced
  int temperatures = 0;    ///< completed temperatures
  double temperature = 0;  ///< at the end
  double spread = 0;       ///< largest difference among the costs of the termination test
  bool annealed = false;   ///< true: the costs agree; false: the cost function stopped the search
};

/// Sets the cost at x; an infinite cost rejects the point. Returns false to stop the search at once.
using AnnealingCost = std::function<bool(const Vector& x, double& cost)>;

/// Minimises over lower <= x <= upper.
///
/// One variable at a time moves by a uniform step of at most VM; a trial outside of the bounds is replaced by
/// one drawn uniformly between them. A lower cost is accepted, a higher one with probability exp(-rise / T).
/// After NS moves of every variable its VM grows or shrinks so that about half of its moves are accepted;
/// after NT such adjustments T falls by RT and the search goes on from the best point. It ends when the last
/// costs at NEPS successive temperatures agree with each other and with the best within EPS.
///
/// @param start [n] @param start_cost cost at start, infinite if it has none
/// @param uniform random numbers in [0, 1); the order in which they are used is that of the published
/// program. Source: Corana, Marchesi, Martini, Ridella (1987), ACM TOMS 13(3):262-280; Goffe, Ferrier, Rogers
/// (1994), J. Econometrics 60:65-99, program simann.f 3.2. Departure: relative_tolerance.
AnnealingResult Anneal(const AnnealingCost& cost, const Vector& lower, const Vector& upper,
                       const Vector& start, double start_cost, const AnnealingSchedule& schedule,
                       const std::function<double()>& uniform);

}  // namespace sinew::solvers
