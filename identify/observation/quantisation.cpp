#include "identify/observation/quantisation.h"

#include <algorithm>
#include <cmath>

namespace sinew {
namespace {

constexpr std::size_t kMinValues = 20;
constexpr std::size_t kMinLevels = 4;
constexpr double kMinShareOfMultiples = 0.99;
constexpr double kTolerance = 0.02;       // of the step
constexpr double kSmallestStep = 1e-6;    // of the largest value
constexpr double kEqualTolerance = 1e-9;  // of the largest value: closer values count as one
constexpr int kMaxSteps = 12;

// The step of which almost all `values` are multiples, given an approximate `trial_step`. Values come in
// increasing magnitude, so that the step is known well enough for each next multiple.
std::optional<double> Refine(const std::vector<double>& values, double trial_step) {
  const auto allowed =
      static_cast<std::size_t>((1 - kMinShareOfMultiples) * static_cast<double>(values.size()));
  double step = trial_step;
  double products = trial_step;
  double squares = 1;
  std::size_t misses = 0;
  std::size_t hits = 0;
  for (const double value : values) {
    const double multiple = std::round(value / step);
    if (std::abs(value - multiple * step) > kTolerance * step) {
      if (++misses > allowed) return std::nullopt;
      continue;
    }
    if (multiple == 0) continue;  // zero is a multiple of every step, and signals at rest have many
    ++hits;
    products += value * multiple;
    squares += multiple * multiple;
    step = products / squares;
  }
  if (static_cast<double>(hits) < kMinShareOfMultiples * static_cast<double>(hits + misses))
    return std::nullopt;
  return step;
}

void SortByMagnitude(std::vector<double>& values) {
  std::sort(values.begin(), values.end(), [](double a, double b) {
    return std::abs(a) != std::abs(b) ? std::abs(a) < std::abs(b) : a < b;
  });
}

// Differences of neighbouring values, increasing; empty if there are too few levels.
std::vector<double> Gaps(const std::vector<double>& sorted, double same) {
  std::vector<double> gaps;
  for (std::size_t i = 1; i < sorted.size(); ++i) {
    const double gap = sorted[i] - sorted[i - 1];
    if (gap > same) gaps.push_back(gap);
  }
  if (gaps.size() + 1 < kMinLevels) gaps.clear();
  std::sort(gaps.begin(), gaps.end());
  return gaps;
}

}  // namespace

std::optional<double> QuantisationStep(const std::vector<double>& values) {
  if (values.size() < kMinValues) return std::nullopt;
  std::vector<double> sorted = values;
  std::sort(sorted.begin(), sorted.end());
  const double largest = std::max(std::abs(sorted.front()), std::abs(sorted.back()));
  const std::vector<double> gaps = Gaps(sorted, kEqualTolerance * largest);
  if (gaps.empty()) return std::nullopt;

  // A difference is a small multiple of the step; the smallest ones may be due to values that are not
  // multiples.
  std::vector<double> trial_steps;
  for (const double quantile : {0.0, 0.01, 0.02, 0.05, 0.1, 0.25, 0.5}) {
    const double gap = gaps[static_cast<std::size_t>(quantile * static_cast<double>(gaps.size() - 1))];
    for (int steps = 1; steps <= kMaxSteps; ++steps) {
      if (gap / steps >= kSmallestStep * largest) trial_steps.push_back(gap / steps);
    }
  }
  std::sort(trial_steps.begin(), trial_steps.end(), std::greater<>());

  // First in the order of distance from the median: near it the multiples are small, however far the values
  // are from zero.
  std::vector<double> around = sorted;
  const double median = sorted[sorted.size() / 2];
  for (double& value : around) value -= median;
  SortByMagnitude(around);
  SortByMagnitude(sorted);
  for (const double trial_step : trial_steps) {
    const auto spacing = Refine(around, trial_step);
    if (!spacing) continue;
    if (const auto step = Refine(sorted, *spacing)) return step;
  }
  return std::nullopt;
}

}  // namespace sinew
