#include "models/emg/movement_period.h"

#include <algorithm>
#include <cmath>

namespace sinew {
namespace {

constexpr std::size_t kMaxStretches = 2048;
constexpr std::size_t kMinPerPeriod = 6;
constexpr double kWeakest = 0.3;
constexpr double kOfTheHighest = 0.9;

// Means about the mean of all; 0 where there is none, with weight 0.
struct Stretches {
  std::vector<double> mean;
  std::vector<double> weight;
};

Stretches Average(const std::vector<double>& time, const std::vector<double>& angle, std::size_t count) {
  Stretches stretches{std::vector<double>(count, 0), std::vector<double>(count, 0)};
  const double length = time.back() - time.front();
  double total = 0;
  double samples = 0;
  for (std::size_t k = 0; k < time.size(); ++k) {
    if (!std::isfinite(angle[k])) continue;
    // The last sample's stretch is as wide as the others'.
    const double place = (time[k] - time.front()) / length * static_cast<double>(count - 1) + 0.5;
    const std::size_t at = std::min(static_cast<std::size_t>(place), count - 1);
    stretches.mean[at] += angle[k];
    stretches.weight[at] += 1;
    total += angle[k];
    samples += 1;
  }
  for (std::size_t i = 0; i < count; ++i) {
    if (stretches.weight[i] == 0) continue;
    stretches.mean[i] = stretches.mean[i] / stretches.weight[i] - total / samples;
    stretches.weight[i] = 1;
  }
  return stretches;
}

double Correlation(const Stretches& x, std::size_t lag) {
  double product = 0;
  double early = 0;
  double late = 0;
  for (std::size_t i = 0; i + lag < x.mean.size(); ++i) {
    const double a = x.mean[i] * x.weight[i + lag];
    const double b = x.mean[i + lag] * x.weight[i];
    product += a * b;
    early += a * a;
    late += b * b;
  }
  const double energy = std::sqrt(early) * std::sqrt(late);
  return energy > 0 && std::isfinite(energy) ? product / energy : 0;
}

}  // namespace

MovementPeriod FindMovementPeriod(const std::vector<double>& time, const std::vector<double>& angle) {
  const std::size_t count = std::min(time.size(), kMaxStretches);
  if (count < 2 * kMinPerPeriod || !std::isfinite(time.back() - time.front())) return {};
  const Stretches stretches = Average(time, angle, count);
  std::vector<double> correlation;
  correlation.reserve(count / 2 + 1);
  for (std::size_t lag = 0; lag <= count / 2; ++lag) correlation.push_back(Correlation(stretches, lag));

  // Peaks are searched after the first lag without correlation.
  std::size_t from = 1;
  while (from < correlation.size() && correlation[from] > 0) ++from;
  from = std::max(from, kMinPerPeriod);
  const auto is_peak = [&](std::size_t lag) {
    return correlation[lag] >= correlation[lag - 1] && correlation[lag] > correlation[lag + 1];
  };
  double highest = kWeakest / kOfTheHighest;
  for (std::size_t lag = from; lag + 1 < correlation.size(); ++lag)
    if (is_peak(lag)) highest = std::max(highest, correlation[lag]);
  for (std::size_t lag = from; lag + 1 < correlation.size(); ++lag) {
    if (!is_peak(lag) || correlation[lag] < kOfTheHighest * highest) continue;
    // The parabola through the peak and its neighbours.
    const double before = correlation[lag] - correlation[lag - 1];
    const double after = correlation[lag] - correlation[lag + 1];
    const double shift = 0.5 * (before - after) / (before + after);
    const double step = (time.back() - time.front()) / static_cast<double>(count - 1);
    return {(static_cast<double>(lag) + shift) * step, correlation[lag]};
  }
  return {};
}

}  // namespace sinew
