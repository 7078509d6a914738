#include "identify/alternative_prediction.h"

#include <cmath>
#include <utility>

#include "identify/problem.h"

namespace sinew {
namespace {

// Leaves out what an alternative does not predict or is not to be compared with.
void Restrict(const AlternativePrediction& alternative, Layout& layout) {
  for (std::size_t b = 0; b < layout.size(); ++b) {
    Block& block = layout[b];
    const bool predicted = alternative.values.empty() || alternative.values[b].size() == block.predictions();
    const std::vector<bool> all;
    const std::vector<bool>& compared = alternative.compared.empty() ? all : alternative.compared[b];
    Block rest = block;
    rest.measured.clear();
    rest.sample.clear();
    for (std::size_t i = 0; predicted && i < block.sample.size(); ++i) {
      if (!compared.empty() && !compared[static_cast<std::size_t>(block.sample[i])]) continue;
      rest.measured.push_back(block.measured[i]);
      rest.sample.push_back(block.sample[i]);
    }
    block = std::move(rest);
  }
}

// Root mean squares over the compared samples of one quality, or of a pooled one; 0 where no band is stated.
double HalfWidth(const AlternativePrediction& alternative, const Layout& layout, const FitQuality& quality) {
  if (alternative.half_width.empty()) return 0;
  double squares = 0;
  double count = 0;
  for (std::size_t b = 0; b < layout.size(); ++b) {
    const Block& block = layout[b];
    const bool pooled = quality.trial.empty();
    const std::string& name = pooled && !block.quantity.empty() ? block.quantity : block.channel;
    if (name != quality.channel || block.role != quality.role || (!pooled && block.trial != quality.trial))
      continue;
    const Vector& half_width = alternative.half_width[b];
    if (half_width.size() != block.predictions()) continue;
    for (const int sample : block.sample) squares += half_width[sample] * half_width[sample];
    count += static_cast<double>(block.sample.size());
  }
  return count > 0 ? std::sqrt(squares / count) : 0;
}

}  // namespace

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
      full.values = alternative.values;
    }
    Restrict(alternative, layout);
    Assess(layout, full);
    AlternativeQuality quality{alternative.name, std::move(full.quality), std::move(full.pooled), {}, {}};
    for (const FitQuality& one : quality.quality)
      quality.half_width.push_back(HalfWidth(alternative, layout, one));
    for (const FitQuality& one : quality.pooled)
      quality.pooled_half_width.push_back(HalfWidth(alternative, layout, one));
    compared.push_back(std::move(quality));
  }
  return compared;
}

}  // namespace sinew
