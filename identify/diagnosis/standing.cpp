#include "identify/diagnosis/standing.h"

#include <algorithm>
#include <cmath>

namespace sinew {
namespace {

constexpr double kLarge = 150;  // statistic above which linear estimates are only a hint
constexpr double kVeryLarge = 2000;
constexpr double kDetectable = 3.605;

// The refit's point with a candidate at one of its probes, `factor` times as large as the linear estimate.
Vector StartAt(const Standing& standing, const ScoreTable& table, const Candidate& candidate,
               const Score& score, double factor) {
  Vector point = standing.refit.point;
  const auto& parameters = standing.refit.setup->parameters;
  for (const auto& [index, value] : candidate.probes[static_cast<std::size_t>(score.probe)].at)
    point[index] = value;
  // What vanishes near its null has no slope there to start from.
  if (IsScoredBySecant(candidate, static_cast<std::size_t>(score.probe))) return point;
  for (const int column : score.columns) {
    const DesignColumn& one = standing.design.columns[static_cast<std::size_t>(column)];
    const Parameter& p = parameters[static_cast<std::size_t>(one.parameter)];
    const double detectable = kDetectable / std::max(table.length[column], 1e-300);
    double change = factor * table.estimate[column];
    if (one.positive) change = std::max(change, 0.3 * detectable);
    if (one.negative) change = std::min(change, -0.3 * detectable);
    const double margin = 1e-3 * (p.upper - p.lower);
    point[one.parameter] = std::clamp(p.null_value + change, one.positive ? p.lower : p.lower + margin,
                                      one.negative ? p.upper : p.upper - margin);
  }
  return point;
}

}  // namespace

const Score* Standing::BestOf(int candidate, const ScoreTable& table) const {
  const Score* best = nullptr;
  for (const Score& score : table.scores) {
    if (score.candidate == candidate && (best == nullptr || score.statistic > best->statistic)) best = &score;
  }
  return best;
}

Result<Standing> StandAt(const Problem& problem, const std::vector<Candidate>& candidates, Refit refit,
                         double level, std::uint64_t seed) {
  Standing standing;
  standing.refit = std::move(refit);
  const LeastSquares fit(problem, *standing.refit.setup);
  const Whitening whitening(standing.refit.noise, TrainStretches(fit));
  SINEW_ASSIGN(standing.design, MakeDesign(fit, standing.refit.x, candidates, whitening));
  standing.whitened = MakeScores(fit, standing.design, candidates, &whitening);
  standing.plain = standing.refit.noise.IsColoured() ? MakeScores(fit, standing.design, candidates, nullptr)
                                                     : standing.whitened;
  standing.family = FamilyOf(standing.whitened, level, seed);
  return standing;
}

std::vector<Vector> StartsFor(const Standing& standing, const std::vector<Candidate>& candidates,
                              int candidate) {
  const Candidate& which = candidates[static_cast<std::size_t>(candidate)];
  const Score* whitened = standing.BestOf(candidate);
  const Score* plain = standing.BestOf(candidate, standing.plain);
  std::vector<Vector> starts;
  if (whitened != nullptr) starts.push_back(StartAt(standing, standing.whitened, which, *whitened, 1));
  if (plain != nullptr && (whitened == nullptr || plain->probe != whitened->probe))
    starts.push_back(StartAt(standing, standing.plain, which, *plain, 1));
  if (plain != nullptr && plain->statistic > kLarge) {
    for (const Score& score : standing.plain.scores) {
      if (score.candidate != candidate || &score == plain) continue;
      starts.push_back(StartAt(standing, standing.plain, which, score, 1));
    }
    if (plain->statistic > kVeryLarge) {
      for (const double factor : {0.3, 3.0})
        starts.push_back(StartAt(standing, standing.plain, which, *plain, factor));
    }
  }
  if (starts.empty()) {
    Vector point = standing.refit.point;
    for (const auto& [index, value] : which.probes.front().at) point[index] = value;
    starts.push_back(std::move(point));
  }
  return starts;
}

}  // namespace sinew
