#include "identify/uncertainty/uncertainty.h"

#include "identify/uncertainty/analysis.h"

namespace sinew {

const char* ToString(IntervalKind kind) {
  switch (kind) {
    case IntervalKind::kProfile:
      return "profile";
    case IntervalKind::kLinear:
      return "linear";
    case IntervalKind::kNone:
      return "none";
  }
  return "?";
}

Result<Uncertainty> AnalyseUncertainty(const LeastSquares& problem, const Vector& x,
                                       const UncertaintyOptions& options) {
  return uncertainty::Analysis(problem, options).Run(x);
}

}  // namespace sinew
