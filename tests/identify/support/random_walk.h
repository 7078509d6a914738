// A trial whose nuisance values continue from sample to sample, through a law with branches.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "base/random.h"
#include "tests/identify/support/classic_problems.h"

namespace sinew {

inline constexpr int kWalkSamples = 60;
inline constexpr double kWalkNoise = 0.01;
inline constexpr double kWalkStep = 0.35;  // [rad] standard deviation of a step of the phase
inline constexpr double kWalkSpeed = 0.4;  // [rad] a sample

/// y = sin(speed i + phase), whose phase is a random walk of normal steps, one every second sample: over a
/// trial it goes through several periods, which only those next to each other tell apart. @return the true
/// steps
inline std::vector<double> AddRandomWalk(FunctionProblem& problem, const std::string& trial, int first_column,
                                         std::uint64_t seed) {
  constexpr int kSteps = kWalkSamples / 2;
  std::vector<int> columns{0};
  for (int k = 0; k < kSteps; ++k) {
    Parameter p;
    p.name = "step" + std::to_string(k) + "@" + trial;
    p.unit = "1";
    p.lower = -8;
    p.upper = 8;
    p.start = 0;
    p.kind = ParameterKind::kNuisance;
    p.trial = trial;
    p.prior = GaussianPrior{0, 1};
    columns.push_back(first_column + k);
    problem.Add(std::move(p));
  }
  Random random(seed);
  std::vector<double> steps;
  std::vector<double> measured;
  double phase = 0;
  for (int i = 0; i < kWalkSamples; ++i) {
    if (i % 2 == 0) {
      steps.push_back(random.Normal());
      phase += kWalkStep * steps.back();
    }
    measured.push_back((std::sin(kWalkSpeed * i + phase) + kWalkNoise * random.Normal()) / kWalkNoise);
  }
  problem.AddBlock(
      trial, measured, columns,
      [first_column](const Vector& p, Eigen::Ref<Vector> predicted, Matrix* derivatives) -> Status {
        double angle = 0;
        for (int i = 0; i < kWalkSamples; ++i) {
          if (i % 2 == 0) angle += kWalkStep * p[first_column + i / 2];
          predicted[i] = std::sin(p[0] * i + angle) / kWalkNoise;
          if (derivatives == nullptr) continue;
          const double slope = std::cos(p[0] * i + angle) / kWalkNoise;
          (*derivatives)(i, 0) = slope * i;
          for (int k = 0; k <= i / 2; ++k) (*derivatives)(i, first_column + k) = slope * kWalkStep;
        }
        return {};
      });
  return steps;
}

/// Largest error of the angle at any step, speed included [rad].
inline double AngleError(const Vector& parameters, int first_column, const std::vector<double>& steps) {
  double walked = 0;
  double largest = 0;
  for (std::size_t k = 0; k < steps.size(); ++k) {
    walked += kWalkStep * (parameters[first_column + static_cast<int>(k)] - steps[k]);
    const double turned = 2 * static_cast<double>(k) * (parameters[0] - kWalkSpeed);
    largest = std::max(largest, std::abs(walked + turned));
  }
  return largest;
}

}  // namespace sinew
