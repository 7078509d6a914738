#include "models/dynamometer/smooth_angle.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/constants.h"
#include "models/emg/butterworth.h"

namespace sinew {
namespace {

constexpr int kOrder = 3;  // of each of the two passes
constexpr double kLowest = 2;
constexpr double kHighest = 40;
constexpr double kRatio = 1.15;      // of neighbouring cut-offs
constexpr double kSettling = 2;      // periods of the cut-off after which the filter has settled
constexpr double kMostOfRate = 0.4;  // above it there is nothing to take away

// Mean gain of both passes over all frequencies.
double MeanGain(double cutoff, double rate) {
  constexpr int kFrequencies = 400;
  const double edge = std::tan(kPi * cutoff / rate);
  double sum = 0;
  for (int i = 0; i < kFrequencies; ++i) {
    const double ratio = std::tan(0.5 * kPi * (i + 0.5) / kFrequencies) / edge;
    sum += 1 / (1 + std::pow(ratio, 2 * kOrder));
  }
  return sum / kFrequencies;
}

// Turned about its ends, so that the filter has settled where the values begin.
Result<std::vector<double>> Filtered(const std::vector<double>& values, double rate, double cutoff) {
  SINEW_ASSIGN(const FilterSections filter, ButterworthLowPass(kOrder, cutoff, rate));
  const std::size_t count = values.size();
  const auto settling = static_cast<std::size_t>(std::ceil(kSettling * rate / cutoff));
  const std::size_t more = count < 2 ? 0 : std::min(settling, count - 1);
  std::vector<double> longer;
  longer.reserve(count + 2 * more);
  for (std::size_t k = more; k > 0; --k) longer.push_back(2 * values.front() - values[k]);
  longer.insert(longer.end(), values.begin(), values.end());
  for (std::size_t k = 1; k <= more; ++k) longer.push_back(2 * values.back() - values[count - 1 - k]);
  SINEW_ASSIGN(const auto filtered, FilterZeroLag(filter, longer));
  const auto first = filtered.begin() + static_cast<std::ptrdiff_t>(more);
  return std::vector<double>(first, first + static_cast<std::ptrdiff_t>(count));
}

}  // namespace

Result<SmoothAngle> SmoothedAngle(const std::vector<double>& values, double rate, double cutoff) {
  if (cutoff >= 0) {
    if (cutoff == 0 || cutoff > kMostOfRate * rate) return SmoothAngle{values, 0};
    SINEW_ASSIGN(auto filtered, Filtered(values, rate, cutoff));
    return SmoothAngle{std::move(filtered), cutoff};
  }
  SmoothAngle best{values, 0};
  double least = std::numeric_limits<double>::infinity();
  for (double f = kLowest; f <= std::min(kHighest, kMostOfRate * rate); f *= kRatio) {
    SINEW_ASSIGN(auto filtered, Filtered(values, rate, f));
    double squares = 0;
    for (std::size_t i = 0; i < values.size(); ++i) squares += std::pow(values[i] - filtered[i], 2);
    const double score = squares / std::pow(1 - MeanGain(f, rate), 2);
    if (!(score < least)) continue;
    least = score;
    best = {std::move(filtered), f};
  }
  return best;
}

}  // namespace sinew
