#include "identify/noise/difference_noise.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "identify/noise/noise_model.h"
#include "identify/observation/quantisation.h"

namespace sinew::noise {
namespace {

constexpr int kLowestOrder = 2;
constexpr int kHighestOrder = 6;
constexpr int kMinDifferences = kSamplesForNoise - kLowestOrder;
constexpr int kComparedOrder = 4;        // with the highest one
constexpr double kLeastAgreement = 0.7;  // of the level of the highest order over that of the compared one
constexpr double kLeastSmallest = 0.5;   // of the smallest level over that of the highest order
constexpr double kStoredDigits = 1e-6;   // of the largest value
constexpr double kAboveRounding = 1.5;   // of a level that is more than rounding, over that of rounding
constexpr double kMedianOfNormal = 0.6744897501960817;  // of |z|, z standard normal

// Squared norm of the coefficients of a difference: the binomial coefficient (2 order over order).
double SquaredNorm(int order) {
  double norm = 1;
  for (int i = 1; i <= order; ++i) norm *= static_cast<double>(order + i) / i;
  return norm;
}

double Median(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Of fewer samples than the highest order takes, the highest ones that there are.
bool OrdersAgree(const std::vector<double>& levels, double smallest) {
  constexpr std::size_t kApart = kHighestOrder - kComparedOrder;
  const std::size_t last = levels.size() - 1;
  return levels[last] >= kLeastAgreement * levels[last - std::min(last, kApart)] &&
         smallest >= kLeastSmallest * levels[last];
}

}  // namespace

std::optional<MeasuredNoise> DifferenceNoise(const Block& block) {
  if (block.noise_memory) return {};
  const std::vector<int> stretches = Stretches(block);
  std::vector<double> levels;  // from kLowestOrder on
  std::vector<double> differences = block.measured;
  std::vector<double> magnitudes;
  for (int order = 1; order <= kHighestOrder; ++order) {
    // After this, differences[i] belongs to samples i - order to i.
    for (std::size_t i = differences.size(); i-- > 1;) differences[i] -= differences[i - 1];
    if (order < kLowestOrder) continue;
    magnitudes.clear();
    for (std::size_t s = 0; s < stretches.size(); ++s) {
      const int end = s + 1 < stretches.size() ? stretches[s + 1] : block.samples();
      for (int i = stretches[s] + order; i < end; ++i)
        magnitudes.push_back(std::abs(differences[static_cast<std::size_t>(i)]));
    }
    if (magnitudes.size() < kMinDifferences) break;
    levels.push_back(Median(magnitudes) / kMedianOfNormal / std::sqrt(SquaredNorm(order)));
  }
  if (levels.empty()) return {};
  double largest = 0;
  for (const double value : block.measured) largest = std::max(largest, std::abs(value));
  const double smallest = *std::min_element(levels.begin(), levels.end());
  const double rounding = QuantisationStep(block.measured).value_or(0) / std::sqrt(12.0);
  if (smallest <= kAboveRounding * rounding) return MeasuredNoise{std::max(smallest, rounding), rounding > 0};
  return MeasuredNoise{smallest, smallest > kStoredDigits * largest && OrdersAgree(levels, smallest)};
}

}  // namespace sinew::noise
