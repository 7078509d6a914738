#include "problems/contact/steps/expected_friction.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/random.h"
#include "problems/contact/load/plate_channels.h"

namespace sinew {
namespace {

constexpr int kPairsOfDraws = 500;
constexpr std::uint64_t kSeedOfDraws = 1;
constexpr std::array<PlateChannel, 3> kOfFriction{kFx, kFz, kFreeMoment};

struct FrictionSums {
  Vector vertical;
  std::array<Vector, kOfFriction.size()> first;
  std::array<Vector, kOfFriction.size()> second;
  double draws = 0;

  explicit FrictionSums(Eigen::Index instants) : vertical(Vector::Zero(instants)) {
    first.fill(vertical);
    second.fill(vertical);
  }
  void Add(const Stance& stance, const Prediction& prediction) {
    for (const int block : stance.blocks) {
      if (!prediction.values(block).allFinite()) return;
    }
    vertical += prediction.values(stance.blocks[kFy]);
    for (std::size_t k = 0; k < kOfFriction.size(); ++k) {
      const auto value = prediction.values(stance.blocks[kOfFriction[k]]);
      first[k] += value;
      second[k] += value.cwiseAbs2();
    }
    draws += 1;
  }
};

}  // namespace

Status TakeExpectedFriction(const ContactProblem& problem, const Stance& stance, StepEstimate& estimate) {
  const auto workspace = problem.NewWorkspace();
  Prediction prediction(problem.layout());
  std::vector<bool> wanted(problem.layout().size(), false);
  for (const int block : stance.blocks) wanted[static_cast<std::size_t>(block)] = true;
  SINEW_TRY(problem.Predict({estimate.parameters, wanted, false, nullptr}, *workspace, prediction));

  const auto [from, to] = stance.motion_errors.OwnRange();
  Random random(kSeedOfDraws);
  FrictionSums sums(estimate.value[kFy].size());
  Vector normal(to - from);
  Vector at = estimate.parameters;
  for (int pair = 0; pair < kPairsOfDraws; ++pair) {
    for (double& z : normal) z = random.Normal();
    const Vector apart = estimate.precision.matrixU().solve(normal);
    for (const double sign : {1.0, -1.0}) {
      for (int i = from; i < to; ++i) {
        const Parameter& p = problem.parameters()[static_cast<std::size_t>(i)];
        at[i] = std::clamp(estimate.parameters[i] + sign * apart[i - from], p.lower, p.upper);
      }
      if (problem.Predict({at, wanted, false, nullptr}, *workspace, prediction)) sums.Add(stance, prediction);
    }
  }
  for (std::size_t k = 0; k < kOfFriction.size(); ++k) {
    const auto channel = static_cast<std::size_t>(kOfFriction[k]);
    for (Eigen::Index t = 0; t < sums.vertical.size(); ++t) {
      if (!(sums.vertical[t] > 0)) continue;
      const double mean = sums.first[k][t] / sums.draws;
      estimate.value[channel][t] = sums.first[k][t] / sums.vertical[t] * estimate.value[kFy][t];
      estimate.deviation[channel][t] = std::sqrt(std::max(0.0, sums.second[k][t] / sums.draws - mean * mean));
    }
  }
  return {};
}

}  // namespace sinew
