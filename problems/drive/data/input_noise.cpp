#include "problems/drive/data/input_noise.h"

#include <algorithm>
#include <cmath>

#include "base/constants.h"

namespace sinew {
namespace {

constexpr double kUneven = 0.01;
constexpr double kHighestCutoff = 0.25;  // cycles per sample
constexpr double kMoreThanNoise = 2;     // power between two cut-offs over that of white noise
constexpr double kUnlikeStated =
    0.5;  // difference of the variance above the highest cut-off from the stated one
constexpr double kNextCutoff = 0.8;  // over the one before
constexpr double kHalfLength = 3;    // of the filter, in periods of its cut-off
constexpr std::size_t kFilters = 8;  // half lengths in the record, at least

std::size_t HalfLength(double cutoff) {
  return static_cast<std::size_t>(std::ceil(kHalfLength / cutoff));
}

// Weights of a sample and of those at 1, 2, ... samples on either side.
std::vector<double> Weights(double cutoff) {
  const std::size_t half = HalfLength(cutoff);
  std::vector<double> weights(half + 1);
  double sum = 0;
  for (std::size_t k = 0; k <= half; ++k) {
    const auto at = static_cast<double>(k);
    const double sinc = k == 0 ? 2 * cutoff : std::sin(2 * kPi * cutoff * at) / (kPi * at);
    const double phase = kPi * at / static_cast<double>(half + 1);
    weights[k] = sinc * (0.42 + 0.5 * std::cos(phase) + 0.08 * std::cos(2 * phase));
    sum += (k == 0 ? 1 : 2) * weights[k];
  }
  for (double& weight : weights) weight /= sum;
  return weights;
}

// Value at sample 0 of the straight line through the first samples, or the last ones if step is -1.
double AtEnd(const std::vector<double>& values, bool last, std::size_t count) {
  double sum = 0;
  double moment = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double value = values[last ? values.size() - 1 - i : i];
    sum += value;
    moment += static_cast<double>(i) * value;
  }
  const auto n = static_cast<double>(count);
  return (2 * (2 * n - 1) * sum - 6 * moment) / (n * (n + 1));
}

bool IsEven(const std::vector<double>& time) {
  const double interval = (time.back() - time.front()) / static_cast<double>(time.size() - 1);
  for (std::size_t i = 1; i < time.size(); ++i) {
    if (std::abs(time[i] - time[i - 1] - interval) > kUneven * interval) return false;
  }
  return true;
}

double MeanSquareDifference(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return sum / static_cast<double>(a.size());
}

// Share of white noise that the filter takes out.
double TakenOut(double cutoff) {
  const std::vector<double> weights = Weights(cutoff);
  double share = (1 - weights[0]) * (1 - weights[0]);
  for (std::size_t k = 1; k < weights.size(); ++k) share += 2 * weights[k] * weights[k];
  return share;
}

}  // namespace

std::vector<double> LowPass(const std::vector<double>& values, double cutoff) {
  const std::vector<double> weights = Weights(cutoff);
  const std::size_t half = weights.size() - 1;
  const std::size_t n = values.size();
  if (n <= half) return values;
  const std::size_t count = std::max<std::size_t>(2, half / 4);
  const double first = AtEnd(values, false, count);
  const double last = AtEnd(values, true, count);
  std::vector<double> extended(n + 2 * half);
  for (std::size_t k = 1; k <= half; ++k) {
    extended[half - k] = 2 * first - values[k];
    extended[half + n - 1 + k] = 2 * last - values[n - 1 - k];
  }
  std::copy(values.begin(), values.end(), extended.begin() + static_cast<std::ptrdiff_t>(half));
  std::vector<double> smooth(n);
  for (std::size_t i = 0; i < n; ++i) {
    double sum = weights[0] * extended[half + i];
    for (std::size_t k = 1; k <= half; ++k)
      sum += weights[k] * (extended[half + i - k] + extended[half + i + k]);
    smooth[i] = sum;
  }
  return smooth;
}

InputNoise SmoothInput(const std::vector<double>& time, std::vector<double>& values, double stated) {
  InputNoise noise{stated, 0};
  if (values.size() < kFilters * HalfLength(kHighestCutoff) || !IsEven(time)) return noise;
  const double white =
      MeanSquareDifference(values, LowPass(values, kHighestCutoff)) / TakenOut(kHighestCutoff);
  if (std::abs(white / (stated * stated) - 1) > kUnlikeStated) return noise;
  double passes = 0;
  double share = TakenOut(kHighestCutoff);
  double taken = share * white;
  for (double cutoff = kHighestCutoff * kNextCutoff; kFilters * HalfLength(cutoff) <= values.size();
       cutoff *= kNextCutoff) {
    const double more = TakenOut(cutoff);
    const double then = MeanSquareDifference(values, LowPass(values, cutoff));
    if (then - taken > kMoreThanNoise * (more - share) * white) break;
    share = more;
    taken = then;
    passes = cutoff;
  }
  if (passes == 0) return noise;
  noise.cutoff = passes;
  values = LowPass(values, noise.cutoff);
  return noise;
}

}  // namespace sinew
