#include "identify/alternative_prediction.h"

#include <utility>

#include "identify/problem.h"

namespace sinew {

std::vector<AlternativeQuality> CompareAlternatives(const Problem& problem, const Vector& parameters) {
  std::vector<AlternativeQuality> compared;
  for (AlternativePrediction& alternative : problem.Alternatives(parameters)) {
    FullPrediction full;
    Layout layout = problem.layout();
    if (alternative.parameters.size() > 0) {
      auto predicted = PredictAll(problem, alternative.parameters);
      if (!predicted) continue;
      full = std::move(*predicted);
    } else {
      full.values = std::move(alternative.values);
      for (std::size_t b = 0; b < layout.size(); ++b) {
        if (full.values[b].size() == layout[b].predictions()) continue;
        layout[b].measured.clear();  // nothing to compare
        layout[b].sample.clear();
      }
      Assess(layout, full);
    }
    compared.push_back({alternative.name, std::move(full.quality), std::move(full.pooled)});
  }
  return compared;
}

}  // namespace sinew
