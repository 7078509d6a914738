#include "identify/diagnosis/score/scored_model.h"

#include <algorithm>
#include <cmath>

#include "base/column_space.h"
#include "base/decompositions.h"
#include "identify/execution/executor.h"

namespace sinew::diagnosis {
namespace {

constexpr double kLarge = 150;  // statistic above which linear estimates are only start values
constexpr double kVeryLarge = 2000;

// The refit's point with a candidate at one of its probes, at `factor` times its linear estimate.
Vector StartAt(const ScoredModel& scored, const ScoreTable& table, const Candidate& candidate,
               const Score& score, double factor) {
  Vector point = scored.refit.point;
  const auto& parameters = scored.refit.setup->parameters;
  for (const auto& [index, value] : candidate.probes[static_cast<std::size_t>(score.probe)].at)
    point[index] = value;
  // A candidate that is scored by a secant has no linear estimate: its probe value is the start.
  if (IsScoredBySecant(candidate, static_cast<std::size_t>(score.probe))) return point;
  for (const int column : score.columns) {
    const DesignColumn& one = scored.design.columns[static_cast<std::size_t>(column)];
    const Parameter& p = parameters[static_cast<std::size_t>(one.parameter)];
    const double detectable = kDetectableLength / std::max(table.length[column], 1e-300);
    double change = factor * table.estimate[column];
    if (one.positive) change = std::max(change, 0.3 * detectable);
    if (one.negative) change = std::min(change, -0.3 * detectable);
    const double margin = 1e-3 * (p.upper - p.lower);
    point[one.parameter] = std::clamp(p.null_value + change, one.positive ? p.lower : p.lower + margin,
                                      one.negative ? p.upper : p.upper - margin);
  }
  return point;
}

// Statistics that are nearer to the largest one than both: another probe may be the right one.
constexpr double kCloseProbe = 12;
constexpr double kCloseProbeShare = 0.5;
constexpr std::size_t kOtherProbes = 6;  // of one candidate, from which a refit starts beside the best one
constexpr Eigen::Index kRowsPerDirection = 50;
constexpr Eigen::Index kMaxDirections = 40;
constexpr double kFewProbes = 12;  // of one candidate, which count in full
constexpr double kRejected = 10;   // deviance
constexpr double kSingularCovariance = 1e-8;
constexpr double kMinShare = 1e-4;  // smallest eigenvalue that counts, as a share of the largest

// Further scores of the same candidate, the largest first; of an effect not all.
std::vector<const Score*> OtherScores(const ScoreTable& table, const Score& best, bool effect) {
  std::vector<const Score*> others;
  for (const Score& score : table.scores) {
    if (score.candidate == best.candidate && &score != &best) others.push_back(&score);
  }
  std::stable_sort(others.begin(), others.end(),
                   [](const Score* a, const Score* b) { return a->statistic > b->statistic; });
  if (effect) others.resize(std::min(others.size(), kOtherProbes));
  return others;
}

// Leading directions of the columns of all candidates, projected off the base, unit length [m x r].
Matrix LeadingDirections(const Design& design, const std::vector<Candidate>& candidates) {
  const Vector before = design.candidates.colwise().norm();
  Matrix columns = ColumnSpace(design.base, kSingularCovariance).TakenFrom(design.candidates);
  for (Eigen::Index k = 0; k < columns.cols(); ++k) {
    const double left = columns.col(k).norm();
    // A candidate with many probes must not be all that the directions hold.
    const auto c = static_cast<std::size_t>(design.columns[static_cast<std::size_t>(k)].candidate);
    const double share =
        std::sqrt(std::min(1.0, kFewProbes / static_cast<double>(candidates[c].probes.size())));
    columns.col(k) *= left > 1e-3 * before[k] ? share / left : 0;
  }
  const Eigen::SelfAdjointEigenSolver<Matrix> eigen(Gram(columns));
  const auto last = eigen.eigenvalues().size() - 1;
  const Eigen::Index most = std::min(kMaxDirections, columns.rows() / kRowsPerDirection);
  Eigen::Index count = 0;
  while (count < std::min(most, last + 1) &&
         eigen.eigenvalues()[last - count] > kMinShare * eigen.eigenvalues()[last]) {
    ++count;
  }
  Matrix directions(columns.rows(), count);
  for (Eigen::Index i = 0; i < count; ++i)
    directions.col(i) =
        columns * eigen.eigenvectors().col(last - i) / std::sqrt(eigen.eigenvalues()[last - i]);
  return directions;
}

// If a model lacks an effect, the noise model of its residual partly absorbs that effect; so the leading
// directions of all candidates are regressors when the noise is estimated.
Result<noise::NoiseModel> NoiseWithCandidatesFitted(const LeastSquares& fit, const Vector& x,
                                                    const Design& design,
                                                    const std::vector<Candidate>& candidates,
                                                    const noise::NoiseModel& own, bool white) {
  SINEW_ASSIGN(auto rows, NoiseRowsAt(fit, x));
  std::vector<noise::NoiseBlock>& blocks = rows.blocks;
  const Matrix directions = LeadingDirections(design, candidates);
  for (std::size_t t = 0; t < blocks.size(); ++t) {
    noise::NoiseBlock& block = blocks[t];
    const auto samples = block.residual.size();
    block.regressors.conservativeResize(samples, block.regressors.cols() + directions.cols());
    block.regressors.rightCols(directions.cols()) =
        directions.middleRows(fit.train_blocks()[t].first_row, samples);
    for (Eigen::Index k = 0; k < directions.cols(); ++k)
      block.columns.push_back(fit.variables() + static_cast<int>(k));
  }
  noise::NoiseModelOptions how;
  how.white = white;
  how.priors = std::move(rows.priors);
  SINEW_ASSIGN(auto behind, noise::EstimateNoiseModel(blocks, how));
  // With so many regressors the estimate has a larger variance; it is used only if the likelihood clearly
  // rejects the other one.
  const double rejection =
      noise::RestrictedDeviance(blocks, own, how) - noise::RestrictedDeviance(blocks, behind, how);
  return rejection > kRejected ? behind : own;
}

}  // namespace

double ScoredModel::AlarmPValue() const {
  constexpr double kLineWeight = 20;  // the spectral line gets a twentieth of the level
  return line ? std::min(family.p_value, std::min(1.0, kLineWeight * line->p_value)) : family.p_value;
}

const Score* ScoredModel::BestOf(int candidate, const ScoreTable& table) const {
  const Score* best = nullptr;
  for (const Score& score : table.scores) {
    if (score.candidate == candidate && (best == nullptr || score.statistic > best->statistic)) best = &score;
  }
  return best;
}

Result<ScoredModel> ScoreModel(const Problem& problem, const std::vector<Candidate>& candidates, Refit refit,
                               double level, std::uint64_t seed, ScoredCandidates which) {
  ScoredModel scored;
  scored.refit = std::move(refit);
  const LeastSquares fit(problem, *scored.refit.setup);
  const noise::Whitening whitening(scored.refit.noise, TrainStretches(fit));
  SINEW_ASSIGN(scored.design, MakeDesign(fit, scored.refit.x, candidates, whitening, which));
  const bool coloured = scored.refit.noise.IsColoured();
  Status status;
  const auto score_whitened = [&]() -> Status {
    // Noise of the inputs does not come from the residual, so no effect can be in it.
    scored.noise = scored.refit.noise;
    if (!scored.refit.holds_input_noise) {
      SINEW_ASSIGN(scored.noise,
                   NoiseWithCandidatesFitted(fit, scored.refit.x, scored.design, candidates,
                                             scored.refit.noise, scored.refit.noise_absorbs_misfit));
    }
    const noise::Whitening behind(scored.noise, TrainStretches(fit));
    scored.whitened = MakeScores(fit, scored.design, candidates, &behind);
    scored.family = FamilyOf(scored.whitened, level, seed);
    return {};
  };
  // Each writes its own part: between the refits of a diagnosis one thread would do this alone.
  CurrentExecutor().ForEach(3, [&](std::size_t part, std::size_t) {
    if (part == 0) status = score_whitened();
    if (part == 1) scored.line = noise::FindLine(fit, scored.design.residual);
    if (part == 2 && coloured) scored.plain = MakeScores(fit, scored.design, candidates, nullptr);
  });
  SINEW_TRY(status);
  if (!coloured) scored.plain = scored.whitened;
  return scored;
}

std::vector<Vector> RefitStarts(const ScoredModel& scored, const std::vector<Candidate>& candidates,
                                int candidate) {
  const Candidate& which = candidates[static_cast<std::size_t>(candidate)];
  const Score* whitened = scored.BestOf(candidate);
  const Score* plain = scored.BestOf(candidate, scored.plain);
  std::vector<Vector> starts;
  if (whitened != nullptr) starts.push_back(StartAt(scored, scored.whitened, which, *whitened, 1));
  if (plain != nullptr && (whitened == nullptr || plain->probe != whitened->probe))
    starts.push_back(StartAt(scored, scored.plain, which, *plain, 1));
  // Probes that the scores do not tell apart.
  if (whitened != nullptr) {
    const auto close = [&](const Score& score) {
      return score.statistic > whitened->statistic - kCloseProbe &&
             score.statistic > kCloseProbeShare * whitened->statistic;
    };
    for (const Score* score : OtherScores(scored.whitened, *whitened, which.known)) {
      if (close(*score)) starts.push_back(StartAt(scored, scored.whitened, which, *score, 1));
    }
  }
  if (plain != nullptr && plain->statistic > kLarge) {
    for (const Score* score : OtherScores(scored.plain, *plain, which.known))
      starts.push_back(StartAt(scored, scored.plain, which, *score, 1));
    if (plain->statistic > kVeryLarge) {
      for (const double factor : {0.3, 3.0})
        starts.push_back(StartAt(scored, scored.plain, which, *plain, factor));
    }
  }
  if (starts.empty()) {
    Vector point = scored.refit.point;
    for (const auto& [index, value] : which.probes.front().at) point[index] = value;
    starts.push_back(std::move(point));
  }
  return starts;
}

}  // namespace sinew::diagnosis
