#include "identify/guarded.h"

#include <exception>

#include "base/text.h"

namespace sinew {

Status PredictGuarded(const Problem& problem, const Query& query, Problem::Workspace& workspace,
                      Prediction& prediction) {
  try {
    return problem.Predict(query, workspace, prediction);
  } catch (const std::exception& exception) {
    return Fail("the model threw: {}", OneLine(exception.what()));
  }
}

}  // namespace sinew
