// Solvers `nlopt:ALGORITHM`: every algorithm of the NLopt library by its NLopt name.
#pragma once

#include <memory>
#include <string>

#include "identify/solvers/solver.h"

namespace sinew::solvers {

/// @param algorithm as in `nlopt:LN_BOBYQA`; any algorithm name of NLopt. Johnson, S. G., The NLopt
/// nonlinear-optimization package, github.com/stevengj/nlopt.
///
/// Gradients are J'r. Constraints are passed to the algorithms that support them; all others reject the
/// points that violate one. A point without prediction gets twice the largest cost so far, because NLopt's
/// models need finite numbers. Local searches (and those inside MLSL and AUGLAG: BOBYQA or L-BFGS) stop on
/// the relative change of the cost or on a step of 1e-10 in the unit box. Many global ones have no such test:
/// without a budget they get 20,000 evaluations. Solves in one process run one after another: NLopt's random
/// generator is global. Errors: a name that is not one of NLopt's.
Result<std::unique_ptr<Solver>> MakeNlopt(const std::string& algorithm, const SolverOptions& options);

}  // namespace sinew::solvers
