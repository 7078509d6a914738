#include "problems/contact/load/plate_samples.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "base/local_polynomial.h"
#include "base/median.h"
#include "identify/observation/later_readings.h"
#include "identify/statistics/distributions.h"

namespace sinew {
namespace {

constexpr double kRounding = 1e-9;  // [s]
// On both sides of a frame, of the time between frames. A parabola over a whole one rounds off touch-down and
// the reversal of friction, by 3 to 7 N where every sample's noise is 3 N (benchmarks/motion_errors).
constexpr double kWindowShare = 0.25;

// 0: fewer than two times.
double MedianStep(const std::vector<double>& time) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < time.size(); ++i) steps.push_back(time[i] - time[i - 1]);
  return steps.empty() ? 0 : UpperMedian(steps);
}

// The vertical force of the plate in the same grid; nullptr: none.
const std::vector<double>* VerticalForce(const Grid& grid, const std::string& plate) {
  const auto force = grid.channels.find(plate + "_force_y");
  return force == grid.channels.end() ? nullptr : &force->second.values;
}

double Greatest(const std::vector<double>* force) {
  double most = 0;
  if (force == nullptr) return most;
  for (const double f : *force) most = std::isfinite(f) ? std::max(most, f) : most;
  return most;
}

// A channel whose unknown samples are not finite, and their weights.
struct Samples {
  const std::vector<double>& time;
  const std::vector<double>& values;
  const std::vector<double>& weights;
  double level = 0;     // standard deviation of their noise
  double heaviest = 0;  // weight
};

struct Window {
  std::size_t begin = 0;
  std::size_t end = 0;
};

Window Within(const std::vector<double>& time, double middle, double half) {
  const auto begin = std::lower_bound(time.begin(), time.end(), middle - half - kRounding);
  const auto end = std::upper_bound(begin, time.end(), middle + half + kRounding);
  return {static_cast<std::size_t>(begin - time.begin()), static_cast<std::size_t>(end - time.begin())};
}

// How far samples may be from a time, and how many of them are at most.
struct Width {
  double half = 0;  // [s]
  std::size_t most = 0;
};

Width WidthOf(const std::vector<double>& time, const std::vector<double>& middles, double half) {
  Width width{half, 0};
  for (const double middle : middles) {
    const Window window = Within(time, middle, half);
    width.most = std::max(width.most, window.end - window.begin);
  }
  return width;
}

// Are there samples around `time`, all of them known but those without weight, of a mean weight above
// `lightest`?
bool KnownAround(const Samples& samples, const std::vector<double>& values, double time, double half,
                 double lightest) {
  const Window window = Within(samples.time, time, half);
  double weight = 0;
  for (std::size_t k = window.begin; k < window.end; ++k) {
    if (samples.weights[k] > 0 && !std::isfinite(values[k])) return false;
    weight += samples.weights[k];
  }
  return weight > lightest * static_cast<double>(window.end - window.begin);
}

constexpr int kParabola = 2;

struct Around {
  std::size_t begin = 0;
  std::vector<double> from_middle;  // [s]
  std::vector<double> weights;      // 0 where nothing is known
};

Around SamplesAround(const Samples& samples, double time, double half) {
  const Window window = Within(samples.time, time, half);
  Around around;
  around.begin = window.begin;
  for (std::size_t k = window.begin; k < window.end; ++k) {
    around.from_middle.push_back(samples.time[k] - time);
    around.weights.push_back(std::isfinite(samples.values[k]) ? samples.weights[k] : 0);
  }
  return around;
}

// Is what a parabola leaves of the samples around `time` no more than noise? A chi-squared test.
bool IsParabolaAround(const Samples& samples, double time, double half) {
  constexpr double kLevel = 1e-3;
  const Around around = SamplesAround(samples, time, half);
  const auto& weights = around.weights;
  const auto known = std::count_if(weights.begin(), weights.end(), [](double weight) { return weight > 0; });
  const auto freedom = static_cast<double>(known) - (kParabola + 1);
  if (freedom <= 0) return true;
  const auto begin = samples.values.begin() + static_cast<std::ptrdiff_t>(around.begin);
  const std::vector<double> values(begin, begin + static_cast<std::ptrdiff_t>(weights.size()));
  const double left = LocalPolynomialResidual(around.from_middle, values, weights, kParabola);
  const double squares = left / (samples.heaviest * samples.level * samples.level);
  return !(statistics::ChiSquaredUpperTail(squares, freedom) < kLevel);
}

// The parabola through the samples around `time`, or where they lie on one side of it and would make the
// noise too large, a line or their mean. No coefficients: none is known.
LaterReadings::Sum FitAround(const Samples& samples, double time, const Width& width) {
  // [variance of a sample, divided by their number in a window] Four times that of a parabola through all.
  constexpr double kMostNoise = 9;
  const Around around = SamplesAround(samples, time, width.half);
  LaterReadings::Sum sum;
  sum.begin = around.begin;
  for (int degree = kParabola; degree >= 0; --degree) {
    sum.coefficients = LocalPolynomial(around.from_middle, around.weights, degree);
    if (sum.coefficients.empty()) continue;
    double noise = 0;
    for (const double a : sum.coefficients) noise += a * a;
    if (noise * static_cast<double>(width.most) <= kMostNoise) break;
  }
  return sum;
}

}  // namespace

void AddSamples(const Grid& grid, const Channel& channel, const std::string& plate, bool is_cop,
                double force_share, Block& block) {
  const std::vector<double>* force = is_cop ? VerticalForce(grid, plate) : nullptr;
  const double most = Greatest(force);
  std::size_t p = 0;
  for (std::size_t i = 0; i < grid.time.size(); ++i) {
    while (p < block.prediction_time.size() && block.prediction_time[p] < grid.time[i]) ++p;
    if (p == block.prediction_time.size()) break;
    if (block.prediction_time[p] != grid.time[i] || !std::isfinite(channel.values[i])) continue;
    if (is_cop && !(most > 0 && (*force)[i] > force_share * most)) continue;
    block.sample.push_back(static_cast<int>(p));
    block.measured.push_back(channel.values[i]);
  }
  block.sigma = channel.sigma;
}

void AddLocalFits(const Grid& grid, const Channel& channel, const std::string& plate, bool is_cop,
                  double force_share, double level, Block& block) {
  const std::vector<double>* force = is_cop ? VerticalForce(grid, plate) : nullptr;
  const double most = Greatest(force);
  const double frame = MedianStep(block.prediction_time);
  const double window = kWindowShare * frame;
  const double step = MedianStep(grid.time);
  // A record coarser than the motion is read at the frames that have a sample: between them it says nothing
  // of its own.
  const double nearest = std::max(window, 0.5 * std::min(step, frame));
  if (!(window > 0) || grid.time.empty()) return;
  // Without load a plate computes no centre of pressure, or any.
  std::vector<double> weights(grid.time.size(), 1.0);
  for (std::size_t i = 0; is_cop && i < weights.size(); ++i)
    weights[i] = force == nullptr ? 0 : std::max((*force)[i], 0.0);
  std::vector<double> known = channel.values;
  for (std::size_t i = 0; i < known.size(); ++i) {
    if (weights[i] > 0 && std::isfinite(known[i])) continue;
    known[i] = std::numeric_limits<double>::quiet_NaN();
  }

  const Samples all{grid.time, known, weights, level, *std::max_element(weights.begin(), weights.end())};
  const Width wide = WidthOf(grid.time, block.prediction_time, std::max(window, step));
  const Width narrow = WidthOf(grid.time, block.prediction_time, step);
  std::vector<LaterReadings::Sum> sums;
  std::vector<double> noise;  // variance of what is read, for samples of variance 1
  for (std::size_t p = 0; p < block.prediction_time.size(); ++p) {
    // Frames beside the record are there for late sensors.
    const double time = block.prediction_time[p];
    if (time < grid.time.front() || time > grid.time.back()) continue;
    if (!KnownAround(all, channel.values, time, nearest, is_cop ? force_share * most : 0)) continue;
    const bool smooth = IsParabolaAround(all, time, 2 * wide.half);
    LaterReadings::Sum sum = FitAround(all, time, smooth ? wide : narrow);
    if (sum.coefficients.empty()) continue;
    sum.prediction = static_cast<int>(p);
    double value = 0;
    double squares = 0;
    for (std::size_t j = 0; j < sum.coefficients.size(); ++j) {
      if (sum.coefficients[j] != 0) value += sum.coefficients[j] * known[sum.begin + j];
      squares += sum.coefficients[j] * sum.coefficients[j];
    }
    block.sample.push_back(sum.prediction);
    block.measured.push_back(value);
    noise.push_back(squares);
    sums.push_back(std::move(sum));
  }
  block.later = std::make_shared<LaterReadings>(grid.time, std::move(known), std::move(sums));
  if (!channel.sigma || noise.empty()) return;
  const double usual = UpperMedian(noise);
  block.sigma = *channel.sigma * std::sqrt(usual);
  for (const double n : noise) block.relative_weight.push_back(std::sqrt(usual / n));
}

double ValueAt(const Grid& grid, const Channel& channel, double time) {
  const auto after = std::lower_bound(grid.time.begin(), grid.time.end(), time - kRounding);
  if (after == grid.time.end()) return std::numeric_limits<double>::quiet_NaN();
  const auto i = static_cast<std::size_t>(after - grid.time.begin());
  if (std::abs(*after - time) <= kRounding) return channel.values[i];
  if (i == 0) return std::numeric_limits<double>::quiet_NaN();
  const double share = (time - grid.time[i - 1]) / (grid.time[i] - grid.time[i - 1]);
  return channel.values[i - 1] + share * (channel.values[i] - channel.values[i - 1]);
}

}  // namespace sinew
