// Derivatives of a problem against central differences of its predictions.
#pragma once

#include <vector>

#include "base/error.h"
#include "identify/check_problem.h"
#include "identify/problem.h"

namespace sinew {

/// Which derivatives, and where.
struct DerivativeQuery {
  Vector point;                  ///< [P]
  std::vector<bool> blocks;      ///< [layout]
  std::vector<bool> parameters;  ///< [P]
};

/// Compares one by one; appends to the report. Costs one evaluation with derivatives and four without per
/// parameter. Errors: no prediction, or one that is not finite, at the point.
Status CompareDerivatives(const Problem& problem, const DerivativeQuery& query, double tolerance,
                          JacobianReport& report);

/// Compares along two directions that hold all parameters at once: those with a derivative, so scaled that
/// all count alike, and those without any. False: some derivative may be wrong. Costs one evaluation with
/// derivatives and four without. A point without a prediction on one side agrees.
Result<bool> DirectionsAgree(const Problem& problem, const DerivativeQuery& query, double tolerance);

}  // namespace sinew
