#include "identify/noise/spectral_line.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <map>

#include "base/constants.h"
#include "base/decompositions.h"
#include "identify/statistics/distributions.h"

namespace sinew::noise {
namespace {

constexpr int kMinimum = 64;
constexpr double kUneven = 0.02;
constexpr double kCycles = 4;
constexpr double kMaxFrequencyShare = 0.45;  // of the sampling rate
constexpr std::size_t kNearest = 5;    // neighbours of a frequency are those from this many bins away ...
constexpr std::size_t kFarthest = 30;  // ... to this many; a bin is half of 1 / duration
constexpr double kMinBelow = 4;
constexpr double kBinsPerIndependent = 3;  // bins per independent value with a Hann window

const Block& BlockOf(const LeastSquares& fit, const LeastSquares::TrainBlock& train) {
  return fit.problem().layout()[static_cast<std::size_t>(train.block)];
}

double TimeOf(const Block& block, int i) {
  return block.prediction_time[static_cast<std::size_t>(block.sample[static_cast<std::size_t>(i)])];
}

bool IsEven(const Block& block) {
  if (block.samples() < kMinimum) return false;
  const double mean = (TimeOf(block, block.samples() - 1) - TimeOf(block, 0)) / (block.samples() - 1);
  for (int i = 1; i < block.samples(); ++i) {
    if (std::abs(TimeOf(block, i) - TimeOf(block, i - 1) - mean) > kUneven * mean) return false;
  }
  return true;
}

struct Side {
  double mean = 0;
  double bins = 0;
};

Side MeanOf(const std::vector<double>& power, std::size_t first, std::size_t end) {
  Side side;
  for (std::size_t k = first; k < std::min(end, power.size()); ++k) {
    side.mean += power[k];
    ++side.bins;
  }
  if (side.bins > 0) side.mean /= side.bins;
  return side;
}

// Power at k * bin for k = 0 .. count - 1, in units of its mean.
std::vector<double> Periodogram(const Vector& rows, double step, double bin, std::size_t count) {
  const auto n = rows.size();
  Vector windowed(n);
  for (Eigen::Index i = 0; i < n; ++i)
    windowed[i] = rows[i] * (1 - std::cos(2 * kPi * (static_cast<double>(i) + 0.5) / static_cast<double>(n)));
  std::vector<double> power(count);
  double sum = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const std::complex<double> turn = std::polar(1.0, 2 * kPi * bin * static_cast<double>(k) * step);
    std::complex<double> total = 0;  // Horner
    for (Eigen::Index i = n; i-- > 0;) total = total * turn + windowed[i];
    power[k] = std::norm(total);
    sum += power[k];
  }
  if (sum > 0) {
    for (double& p : power) p *= static_cast<double>(count) / sum;
  }
  return power;
}

}  // namespace

std::optional<SpectralLine> FindLine(const LeastSquares& fit, const Vector& residual) {
  std::map<std::string, std::vector<LeastSquares::TrainBlock>> channels;
  for (const auto& train : fit.train_blocks()) {
    if (IsEven(BlockOf(fit, train))) channels[BlockOf(fit, train).channel].push_back(train);
  }
  std::optional<SpectralLine> best;
  double tried = 0;
  for (const auto& [channel, blocks] : channels) {
    double longest = 0;
    double shortest = 1e300;
    double step = 0;
    for (const auto& train : blocks) {
      const Block& block = BlockOf(fit, train);
      const double duration = TimeOf(block, block.samples() - 1) - TimeOf(block, 0);
      longest = std::max(longest, duration);
      shortest = std::min(shortest, duration);
      step = std::max(step, duration / (block.samples() - 1));
    }
    const double bin = 0.5 / longest;
    const auto count = static_cast<std::size_t>(kMaxFrequencyShare / step / bin);
    const auto first = static_cast<std::size_t>(std::ceil(kCycles / shortest / bin));
    std::vector<double> power(count, 0);
    for (const auto& train : blocks) {
      const Block& block = BlockOf(fit, train);
      const auto own = Periodogram(
          residual.segment(train.first_row, block.samples()),
          (TimeOf(block, block.samples() - 1) - TimeOf(block, 0)) / (block.samples() - 1), bin, count);
      for (std::size_t k = 0; k < count; ++k) power[k] += own[k];
    }
    const double degrees = 2 * static_cast<double>(blocks.size());
    for (std::size_t k = first; k + kFarthest < count; ++k) {
      const Side above = MeanOf(power, k + kNearest, k + kFarthest + 1);
      const Side below =
          MeanOf(power, k > kFarthest ? k - kFarthest : 1, k >= kNearest ? k - kNearest + 1 : 1);
      if (below.bins < kMinBelow) continue;
      // Where the spectrum is steep, the side with more power is the conservative reference.
      const Side& around = above.mean > below.mean ? above : below;
      ++tried;
      if (!(around.mean > 0)) continue;
      const double p = statistics::FUpperTail(power[k] / around.mean, degrees,
                                              degrees * around.bins / kBinsPerIndependent);
      if (!best || p < best->p_value) best = {channel, bin * static_cast<double>(k), p, 0};
    }
  }
  if (best) {
    best->statistic = -2 * std::log(std::max(best->p_value, std::numeric_limits<double>::min()));
    best->p_value = std::min(1.0, tried * best->p_value);
  }
  return best;
}

Vector LineAt(const Block& block, const SpectralLine& line, const Vector& amplitudes) {
  Vector values(block.samples());
  for (int i = 0; i < block.samples(); ++i) {
    const double phase = 2 * kPi * line.frequency * (TimeOf(block, i) - block.prediction_time.front());
    values[i] = amplitudes[0] * std::cos(phase) + amplitudes[1] * std::sin(phase);
  }
  return values;
}

Vector LineAmplitudes(const LeastSquares& fit, const Vector& residual, const SpectralLine& line) {
  Matrix columns = Matrix::Zero(residual.size(), 2);
  Vector rows = Vector::Zero(residual.size());
  for (const auto& train : fit.train_blocks()) {
    const Block& block = BlockOf(fit, train);
    if (block.channel != line.channel) continue;
    rows.segment(train.first_row, block.samples()) = residual.segment(train.first_row, block.samples());
    columns.col(0).segment(train.first_row, block.samples()) = LineAt(block, line, Vector::Unit(2, 0));
    columns.col(1).segment(train.first_row, block.samples()) = LineAt(block, line, Vector::Unit(2, 1));
  }
  return columns.colPivHouseholderQr().solve(rows);
}

}  // namespace sinew::noise
