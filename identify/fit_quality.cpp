#include "identify/fit_quality.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "identify/guarded.h"

namespace sinew {
namespace {

struct Sums {
  double errors = 0;
  double absolute = 0;
  double deviations = 0;
  int n = 0;

  void Fill(FitQuality& quality) const {
    quality.n = n;
    quality.rmse = std::sqrt(errors / n);
    quality.mae = absolute / n;
    quality.r2 = deviations > 0 ? 1 - errors / deviations : std::numeric_limits<double>::quiet_NaN();
  }
};

// Deviations are taken from the mean of each block, also where blocks are pooled: with a common mean, two
// trials that differ only in level would get a high r2 from two constants.
Sums Compare(const Block& block, const Vector& predicted) {
  Sums sums;
  sums.n = block.samples();
  double mean = 0;
  for (const double measured : block.measured) mean += measured / sums.n;
  for (std::size_t i = 0; i < block.measured.size(); ++i) {
    const double error = predicted[block.sample[i]] - block.measured[i];
    sums.errors += error * error;
    sums.absolute += std::abs(error);
    sums.deviations += (block.measured[i] - mean) * (block.measured[i] - mean);
  }
  return sums;
}

}  // namespace

Result<FullPrediction> PredictAll(const Problem& problem, const Vector& parameters) {
  const Layout& layout = problem.layout();
  const auto workspace = problem.NewWorkspace();
  Prediction prediction(layout);
  const std::vector<bool> all(layout.size(), true);
  SINEW_TRY(PredictGuarded(problem, {parameters, all, false, nullptr}, *workspace, prediction));
  FullPrediction full;
  for (std::size_t b = 0; b < layout.size(); ++b)
    full.values.emplace_back(prediction.values(static_cast<int>(b)));
  Assess(layout, full);
  return full;
}

void Assess(const Layout& layout, FullPrediction& full) {
  full.quality.clear();
  full.pooled.clear();
  std::vector<Sums> pooled_sums;
  for (std::size_t b = 0; b < layout.size(); ++b) {
    const Block& block = layout[b];
    if (block.measured.empty()) continue;
    const Sums sums = Compare(block, full.values[b]);
    FitQuality quality{block.trial, block.role, block.channel, block.unit, 0, 0, 0, 0};
    sums.Fill(quality);
    full.quality.push_back(quality);

    const std::string& quantity = block.quantity.empty() ? block.channel : block.quantity;
    auto pool = std::find_if(full.pooled.begin(), full.pooled.end(), [&](const FitQuality& q) {
      return q.role == block.role && q.channel == quantity;
    });
    if (pool == full.pooled.end()) {
      full.pooled.push_back({"", block.role, quantity, block.unit, 0, 0, 0, 0});
      pooled_sums.emplace_back();
      pool = full.pooled.end() - 1;
    }
    Sums& total = pooled_sums[static_cast<std::size_t>(pool - full.pooled.begin())];
    total.errors += sums.errors;
    total.absolute += sums.absolute;
    total.deviations += sums.deviations;
    total.n += sums.n;
  }
  for (std::size_t i = 0; i < full.pooled.size(); ++i) pooled_sums[i].Fill(full.pooled[i]);
}

}  // namespace sinew
