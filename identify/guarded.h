// The boundary to a user's code: what it throws becomes an Error.
#pragma once

#include "base/error.h"
#include "identify/problem.h"

namespace sinew {

/// Problem::Predict. Errors: its own, and what it throws.
Status PredictGuarded(const Problem& problem, const Query& query, Problem::Workspace& workspace,
                      Prediction& prediction);

}  // namespace sinew
