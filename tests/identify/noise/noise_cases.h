// Trials with known noise and smooth regressors, for tests of what estimates the noise.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "base/random.h"
#include "identify/noise/noise_model.h"

namespace sinew::noise {

/// Stationary from the first sample on (after 500 that are thrown away): x_t = sum a_i x_{t-1-i} + sum b_i
/// e_{t-i}, b_0 = 1, plus `white` of standard normal on top.
struct NoiseProcess {
  std::vector<double> autoregression;
  std::vector<double> moving_average;  ///< b_1 ...
  double white = 0;

  [[nodiscard]] Vector Draw(Random& random, int n) const {
    constexpr int kSettle = 500;
    const auto total = static_cast<std::size_t>(n + kSettle);
    std::vector<double> e(total);
    std::vector<double> x(total);
    for (std::size_t t = 0; t < total; ++t) {
      e[t] = random.Normal();
      x[t] = e[t];
      for (std::size_t i = 0; i < moving_average.size() && i < t; ++i)
        x[t] += moving_average[i] * e[t - 1 - i];
      for (std::size_t i = 0; i < autoregression.size() && i < t; ++i)
        x[t] += autoregression[i] * x[t - 1 - i];
    }
    Vector noise(n);
    for (int t = 0; t < n; ++t) {
      noise[t] = x[static_cast<std::size_t>(t + kSettle)];
      if (white > 0) noise[t] += white * random.Normal();
    }
    return noise;
  }
};

/// A few sines below one fiftieth of the sampling rate, like the response of a slow mechanism.
inline Vector SmoothSignal(Random& random, int n) {
  Vector signal = Vector::Zero(n);
  for (int i = 0; i < 5; ++i) {
    const double rate = random.Uniform(0.005, 0.12);
    const double phase = random.Uniform(0, 6.28);
    const double size = random.Normal();
    for (int t = 0; t < n; ++t) signal[t] += size * std::sin(rate * t + phase);
  }
  return signal;
}

/// One block per trial, `shared` smooth regressors for all trials and two per trial (position and speed at
/// the start, fading). The residual is noise alone, as it is before any fit.
inline std::vector<NoiseBlock> SmoothTrials(Random& random, const NoiseProcess& process, int trials, int n,
                                            int shared, const std::string& channel = "position") {
  std::vector<NoiseBlock> blocks;
  for (int b = 0; b < trials; ++b) {
    NoiseBlock block;
    block.channel = channel;
    block.residual = process.Draw(random, n);
    block.regressors.resize(n, shared + 2);
    for (int k = 0; k < shared; ++k) {
      block.regressors.col(k) = SmoothSignal(random, n);
      block.columns.push_back(k);
    }
    for (int t = 0; t < n; ++t) {
      block.regressors(t, shared) = std::exp(-0.01 * t);
      block.regressors(t, shared + 1) = std::exp(-0.01 * t) * std::sin(0.05 * t);
    }
    block.columns.push_back(shared + 2 * b);
    block.columns.push_back(shared + 2 * b + 1);
    block.stretches = {0};
    blocks.push_back(std::move(block));
  }
  return blocks;
}

/// The design of all blocks below each other.
inline Matrix StackedRegressors(const std::vector<NoiseBlock>& blocks) {
  Eigen::Index rows = 0;
  Eigen::Index columns = 0;
  for (const NoiseBlock& block : blocks) {
    rows += block.residual.size();
    if (!block.columns.empty()) columns = std::max<Eigen::Index>(columns, block.columns.back() + 1);
  }
  Matrix stacked = Matrix::Zero(rows, columns);
  Eigen::Index first = 0;
  for (const NoiseBlock& block : blocks) {
    for (std::size_t c = 0; c < block.columns.size(); ++c) {
      stacked.block(first, block.columns[c], block.residual.size(), 1) =
          block.regressors.col(static_cast<Eigen::Index>(c));
    }
    first += block.residual.size();
  }
  return stacked;
}

inline Vector StackedResiduals(const std::vector<NoiseBlock>& blocks) {
  Eigen::Index rows = 0;
  for (const NoiseBlock& block : blocks) rows += block.residual.size();
  Vector stacked(rows);
  Eigen::Index first = 0;
  for (const NoiseBlock& block : blocks) {
    stacked.segment(first, block.residual.size()) = block.residual;
    first += block.residual.size();
  }
  return stacked;
}

}  // namespace sinew::noise
