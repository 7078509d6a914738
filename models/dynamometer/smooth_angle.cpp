#include "models/dynamometer/smooth_angle.h"

#include <cmath>
#include <limits>

#include "base/constants.h"
#include "models/emg/butterworth.h"

namespace sinew {
namespace {

constexpr int kOrder = 2;  // of each of the two passes
constexpr double kLowest = 2;
constexpr double kHighest = 40;
constexpr double kRatio = 1.15;      // of neighbouring cut-offs
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

Result<std::vector<double>> Filtered(const std::vector<double>& values, double rate, double cutoff) {
  SINEW_ASSIGN(const FilterSections filter, ButterworthLowPass(kOrder, cutoff, rate));
  return FilterZeroLag(filter, values);
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
