#include "problems/contact/load/plate_samples.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "base/median.h"
#include "identify/observation/later_readings.h"

namespace sinew {
namespace {

constexpr double kRounding = 1e-9;  // [s]

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

void AddAverages(const Grid& grid, const Channel& channel, const std::string& plate, bool is_cop,
                 double force_share, Block& block) {
  const std::vector<double>* force = is_cop ? VerticalForce(grid, plate) : nullptr;
  const double most = Greatest(force);
  std::vector<double> steps;
  for (std::size_t p = 1; p < block.prediction_time.size(); ++p)
    steps.push_back(block.prediction_time[p] - block.prediction_time[p - 1]);
  if (steps.empty() || grid.time.empty()) return;
  const double half = 0.5 * UpperMedian(steps);
  std::size_t most_samples = 0;
  // Without load a plate computes no centre of pressure, or any.
  std::vector<double> weights(grid.time.size(), 1.0);
  for (std::size_t i = 0; is_cop && i < weights.size(); ++i)
    weights[i] = force == nullptr ? 0 : std::max((*force)[i], 0.0);
  std::vector<LaterReadings::Mean> means;
  for (std::size_t p = 0; p < block.prediction_time.size(); ++p) {
    // Frames beside the record, which are there for late sensors, hold less than half of their samples.
    if (block.prediction_time[p] < grid.time.front() || block.prediction_time[p] > grid.time.back()) continue;
    const double from = block.prediction_time[p] - half - kRounding;
    const double to = block.prediction_time[p] + half - kRounding;
    const auto begin = std::lower_bound(grid.time.begin(), grid.time.end(), from);
    const auto end = std::lower_bound(begin, grid.time.end(), to);
    if (begin == end) continue;
    const LaterReadings::Mean mean{static_cast<int>(p), static_cast<std::size_t>(begin - grid.time.begin()),
                                   static_cast<std::size_t>(end - grid.time.begin())};
    double weight = 0;
    double sum = 0;
    for (std::size_t i = mean.begin; i < mean.end; ++i) {
      weight += weights[i];
      if (weights[i] != 0) sum += weights[i] * channel.values[i];
    }
    const std::size_t count = mean.end - mean.begin;
    if (!std::isfinite(sum) || !(weight > 0)) continue;
    if (is_cop && !(weight > force_share * most * static_cast<double>(count))) continue;
    block.sample.push_back(mean.prediction);
    block.measured.push_back(sum / weight);
    means.push_back(mean);
    most_samples = std::max(most_samples, count);
  }
  block.later =
      std::make_shared<LaterReadings>(grid.time, channel.values, std::move(weights), std::move(means));
  block.sigma = channel.sigma;
  if (block.sigma && most_samples > 0) *block.sigma /= std::sqrt(static_cast<double>(most_samples));
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
