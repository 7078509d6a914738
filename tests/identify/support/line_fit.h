// A straight line through noisy points: the smallest identification with all parts of a run file.
#pragma once

#include <utility>

#include "base/random.h"
#include "identify/identification/identification.h"
#include "tests/identify/support/toy_problem.h"

namespace sinew::toy {

/// y = offset + slope t on a training and a validation trial, with noise of 0.1; z = twice y is not measured.
inline ToyProblem LineProblem() {
  ToyProblem problem({MakeParameter("offset", -10, 10, 0), MakeParameter("slope", -10, 10, 0)},
                     {MakeBlock("train", "y", 30, 2), MakeBlock("train", "z", 5, 2, BlockRole::kPredicted),
                      MakeBlock("check", "y", 20, 2, BlockRole::kValidate)},
                     [](const Block& block, double t, const Vector& p, Vector* gradient) -> Result<double> {
                       const double factor = block.channel == "z" ? 2 : 1;
                       if (gradient != nullptr) *gradient << factor, factor * t;
                       return factor * (p[0] + p[1] * t);
                     });
  Random random(4);
  problem.Measure(Values({1, 3}), [&](const Block&, int) { return 0.1 * random.Normal(); });
  return problem;
}

inline Identification IdentifyLine(const ToyProblem& problem, IdentificationOptions options = {}) {
  return Identify(problem, MakeFitSetup(problem, {}).value(), std::move(options)).value();
}

}  // namespace sinew::toy
