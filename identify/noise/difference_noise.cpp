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

}  // namespace

std::optional<double> DifferenceNoise(const Block& block) {
  if (block.noise_memory) return {};
  const std::vector<int> stretches = Stretches(block);
  double smallest = 0;
  bool found = false;
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
    const double level = Median(magnitudes) / kMedianOfNormal / std::sqrt(SquaredNorm(order));
    smallest = found ? std::min(smallest, level) : level;
    found = true;
  }
  if (!found) return {};
  return std::max(smallest, QuantisationStep(block.measured).value_or(0) / std::sqrt(12.0));
}

}  // namespace sinew::noise
