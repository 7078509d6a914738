#include "identify/diagnosis/select/set_fitter.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include "base/random.h"
#include "identify/diagnosis/select/choice_of_sets.h"
#include "identify/diagnosis/select/many_starts.h"
#include "identify/execution/executor.h"
#include "identify/execution/shared_loop.h"
#include "identify/keep_samples.h"

namespace sinew::diagnosis {
namespace {

constexpr std::size_t kMaxPromising = 10;
constexpr std::size_t kMaxPromisingTerms = 4;
constexpr int kDraws = 20;
// Fits take longer with more trials, and with many trials local searches end in poor local minima less often.
constexpr double kFewTrials = 6;
constexpr std::size_t kMaxSearchedTrials = 20;  // two in each fold
constexpr int kMaxSearchedSamples = 6000;
constexpr double kIdle = 1e-4;  // relative change of the fitted error without a member that changes nothing

std::set<std::string> SearchedTrials(const Problem& problem) {
  const std::vector<std::string> all = TrainingTrials(problem);
  const std::size_t count = std::min(all.size(), kMaxSearchedTrials);
  std::set<std::string> some;
  for (std::size_t i = 0; i < count; ++i) some.insert(all[i * all.size() / count]);
  return some;
}

EditedView Searched(const Problem& problem) {
  const std::set<std::string> trials = SearchedTrials(problem);
  const auto is_searched = [&](const Block& block) {
    return block.role == BlockRole::kTrain && trials.count(block.trial) > 0;
  };
  int samples = 0;
  for (const Block& block : problem.layout()) samples += is_searched(block) ? block.samples() : 0;
  const int every = 1 + (samples - 1) / kMaxSearchedSamples;
  return EditedView(problem, [&](Block& block) {
    if (block.role != BlockRole::kTrain) return;
    if (!is_searched(block)) {
      block.role = BlockRole::kPredicted;
    } else if (every > 1 && !block.measured.empty()) {
      KeepSamples([&](std::size_t i) { return i % static_cast<std::size_t>(every) == 0; }, block);
    }
  });
}

// Of the candidates that are accepted and not in `have`, the best by the linear prediction.
template <class Accepts>
std::vector<int> BestScored(const ScoredModel& scored, const std::vector<Candidate>& candidates,
                            const std::vector<int>& have, std::size_t most, const Accepts& accepts) {
  std::vector<std::pair<double, int>> ranking;
  for (std::size_t c = 0; c < candidates.size(); ++c) {
    const bool in_set = std::binary_search(have.begin(), have.end(), static_cast<int>(c));
    if (in_set || !accepts(candidates[c])) continue;
    const Score* score = scored.BestOf(static_cast<int>(c), scored.plain);
    if (score != nullptr) ranking.emplace_back(-score->statistic, static_cast<int>(c));
  }
  std::sort(ranking.begin(), ranking.end());
  std::vector<int> best;
  for (std::size_t i = 0; i < std::min(ranking.size(), most); ++i) best.push_back(ranking[i].second);
  return best;
}

}  // namespace

bool PredictsBetter(const FittedSet& a, const FittedSet& b) {
  if (a.left_out_error != b.left_out_error) return a.left_out_error < b.left_out_error;
  return a.released.size() < b.released.size();
}

bool FitsBetter(const FittedSet& a, const FittedSet& b) {
  return a.fitted_error < b.fitted_error;
}

std::vector<int> With(std::vector<int> set, int c) {
  set.insert(std::lower_bound(set.begin(), set.end(), c), c);
  return set;
}

std::vector<int> Without(std::vector<int> set, int c) {
  set.erase(std::remove(set.begin(), set.end(), c), set.end());
  return set;
}

bool IsOneLess(const std::vector<int>& smaller, const std::vector<int>& set) {
  return smaller.size() + 1 == set.size() &&
         std::includes(set.begin(), set.end(), smaller.begin(), smaller.end());
}

int MemberBeyond(const std::vector<int>& smaller, const std::vector<int>& set) {
  return *std::mismatch(smaller.begin(), smaller.end(), set.begin()).second;
}

SetFitter::SetFitter(const Problem& problem, const Refitter& refitter,
                     const std::vector<Candidate>& candidates, const DiagnosisOptions& options,
                     ScoredCandidates scored)
    : refitter_(refitter),
      candidates_(candidates),
      options_(options),
      searched_(Searched(problem)),
      searched_refitter_(searched_, refitter.base(), candidates, options.interrupt),
      folds_(FoldsOf(searched_)),
      scored_(scored) {
  const auto trials = static_cast<double>(TrainingTrials(searched_).size());
  draws_ = static_cast<int>(kDraws * std::min(1.0, std::pow(kFewTrials / trials, 2)));
}

double SetFitter::Rows() const {
  double rows = 0;
  for (const Block& block : searched_.layout()) rows += block.role == BlockRole::kTrain ? block.samples() : 0;
  return rows;
}

// Of the Jacobian at the setup's point, searched data [free]; empty where folds do not need them.
Vector SetFitter::ColumnNorms(const FitSetup& setup) const {
  const bool windows =
      std::any_of(folds_.begin(), folds_.end(), [](const Fold& fold) { return fold.window; });
  if (!windows) return {};
  const LeastSquares fit(searched_, setup);
  auto workspace = fit.NewWorkspace();
  SparseJacobian jacobian = fit.NewJacobian();
  Vector residuals;
  Vector squares = Vector::Zero(fit.variables());
  if (!fit.Evaluate(fit.Variables(setup.rest), workspace, residuals, &jacobian)) return squares;
  for (const SparseJacobian::Piece& piece : jacobian.pieces) {
    for (std::size_t k = 0; k < piece.variables.size(); ++k)
      squares[piece.variables[k]] += piece.values.col(static_cast<Eigen::Index>(k)).squaredNorm();
  }
  return squares.cwiseSqrt();
}

std::vector<double> SetFitter::LeftOutErrors(const std::vector<int>& released, const Vector& start,
                                             double tolerance) const {
  std::vector<double> errors;
  FitSetup all = refitter_.SetupWith(released);
  all.rest = start;
  const Vector norms = ColumnNorms(all);
  for (const Fold& fold : folds_) {
    const FoldView view(searched_, fold);
    const FitSetup setup = WithTiedNuisance(WithoutLeftOut(all, fold), fold, norms, start);
    const LeastSquares fit(view, setup);
    const auto found = FitFromStarts(fit, {start}, tolerance);
    if (!found.failure.empty() || !std::isfinite(found.cost)) return {};
    const auto residuals = LeftOutResiduals(searched_, fold, fit.Parameters(found.x), setup.record);
    if (!residuals) return {};
    if (residuals->size() > 0)
      errors.push_back(residuals->norm() / std::sqrt(static_cast<double>(residuals->size())));
  }
  return errors;
}

double SetFitter::LeftOutError(const std::vector<int>& released, const Vector& start) const {
  return GeometricMean(LeftOutErrors(released, start, kTolerance));
}

void SetFitter::Fit(std::vector<FittedSet>& sets, const std::vector<std::vector<Vector>>& starts,
                    double tolerance, std::size_t continued) const {
  ForEachShared(options_.record, options_.threads, sets.size(), [&](std::size_t i, std::size_t) {
    FittedSet& one = sets[i];
    one.fitted_error = std::numeric_limits<double>::infinity();
    one.left_out_error = one.fitted_error;
    if (Interrupted()) return;
    FitSetup setup = refitter_.SetupWith(one.released);
    setup.rest = starts[i].front();
    const LeastSquares fit(searched_, setup);
    const auto found = FitFromManyStarts(fit, starts[i], tolerance, continued);
    if (!found.failure.empty() || !std::isfinite(found.cost)) return;
    one.point = fit.Parameters(found.x);
    one.fitted_error = std::sqrt(2 * found.cost / Rows());
  });
}

void SetFitter::LeaveOut(std::vector<FittedSet>& sets, double tolerance) const {
  ForEachShared(options_.record, options_.threads, sets.size(), [&](std::size_t i, std::size_t) {
    if (!std::isfinite(sets[i].fitted_error) || Interrupted()) return;
    sets[i].fold_errors = LeftOutErrors(sets[i].released, sets[i].point, tolerance);
    sets[i].left_out_error = GeometricMean(sets[i].fold_errors);
  });
}

// @param starts the point with the member at its null is added
FittedSet SetFitter::WithoutMember(const FittedSet& of, int c, std::vector<Vector>& starts) const {
  Vector start = of.point;
  for (const int index : candidates_[static_cast<std::size_t>(c)].parameters)
    start[index] = refitter_.base().rest[index];
  starts.push_back(std::move(start));
  return {Without(of.released, c), {}, 0, 0, {}};
}

std::vector<FittedSet> SetFitter::OneLess(const FittedSet& of, const std::vector<FittedSet>& known,
                                          double most_fitted) const {
  std::vector<FittedSet> smaller;
  std::vector<std::vector<Vector>> starts(of.released.size());
  for (std::size_t i = 0; i < starts.size(); ++i) {
    smaller.push_back(WithoutMember(of, of.released[i], starts[i]));
    for (const FittedSet& one : known) {
      if (one.released == smaller.back().released) starts[i].push_back(one.point);
    }
  }
  Fit(smaller, starts, kTolerance, kContinued);
  std::vector<FittedSet> near;
  std::vector<std::size_t> index;
  for (std::size_t i = 0; i < smaller.size(); ++i) {
    if (!(smaller[i].fitted_error <= most_fitted)) continue;
    index.push_back(i);
    near.push_back(smaller[i]);
  }
  LeaveOut(near, kTolerance);
  for (std::size_t k = 0; k < near.size(); ++k) smaller[index[k]] = std::move(near[k]);
  return smaller;
}

FittedSet SetFitter::WithoutIdle(const FittedSet& of) const {
  FittedSet rest = of;
  for (const int c : of.released) {
    FitSetup setup = refitter_.SetupWith(Without(rest.released, c));
    setup.rest = rest.point;
    for (const int index : candidates_[static_cast<std::size_t>(c)].parameters)
      setup.rest[index] = refitter_.base().rest[index];
    const LeastSquares fit(searched_, setup);
    auto workspace = fit.NewWorkspace();
    const auto cost = fit.Cost(fit.Variables(setup.rest), workspace);
    if (!cost) continue;
    const double error = std::sqrt(2 * *cost / Rows());
    if (!(error <= (1 + kIdle) * of.fitted_error)) continue;
    rest = {Without(rest.released, c), setup.rest, error, 0, {}};
  }
  return rest;
}

Vector SetFitter::Continued(const FittedSet& of, int c) const {
  FitSetup setup = refitter_.SetupWith(Without(of.released, c));
  Vector point = of.point;
  for (const double share : {0.75, 0.5, 0.25, 0.0}) {
    for (const int index : candidates_[static_cast<std::size_t>(c)].parameters) {
      const double null = refitter_.base().rest[index];
      point[index] = null + share * (of.point[index] - null);
    }
    setup.rest = point;
    const LeastSquares fit(searched_, setup);
    const auto found = FitFromStarts(fit, {point}, kRoughTolerance);
    if (found.failure.empty() && std::isfinite(found.cost)) point = fit.Parameters(found.x);
  }
  return point;
}

std::vector<FittedSet> SetFitter::OneLessByContinuation(const FittedSet& of) const {
  std::vector<FittedSet> smaller;
  std::vector<std::vector<Vector>> starts(of.released.size());
  for (std::size_t i = 0; i < starts.size(); ++i)
    smaller.push_back(WithoutMember(of, of.released[i], starts[i]));
  ForEachShared(options_.record, options_.threads, starts.size(), [&](std::size_t i, std::size_t) {
    if (!Interrupted()) starts[i].push_back(Continued(of, of.released[i]));
  });
  Fit(smaller, starts, kTolerance, kContinued);
  LeaveOut(smaller, kTolerance);
  return smaller;
}

Result<std::optional<ScoredModel>> SetFitter::Score(const FittedSet& one) const {
  Refit refit = searched_refitter_.FitOrdinary(one.released, {one.point}, kTolerance);
  if (!refit.usable()) return std::optional<ScoredModel>();
  SINEW_ASSIGN(ScoredModel scored, ScoreModel(searched_, candidates_, std::move(refit), options_.alarm_level,
                                              options_.seed, scored_));
  return std::optional<ScoredModel>(std::move(scored));
}

Result<std::vector<std::optional<ScoredModel>>> SetFitter::Score(const std::vector<FittedSet>& sets) const {
  std::vector<Result<std::optional<ScoredModel>>> each(sets.size());
  CurrentExecutor().ForEach(sets.size(), [&](std::size_t i, std::size_t) { each[i] = Score(sets[i]); });
  std::vector<std::optional<ScoredModel>> scored;
  for (Result<std::optional<ScoredModel>>& one : each) {
    SINEW_TRY(one);
    scored.push_back(std::move(*one));
  }
  return scored;
}

std::vector<int> SetFitter::Promising(const ScoredModel& scored, const std::vector<int>& have) const {
  return BestScored(scored, candidates_, have, kMaxPromising,
                    [](const Candidate& candidate) { return candidate.primary(); });
}

std::vector<int> SetFitter::PromisingTerms(const ScoredModel& scored, const std::vector<int>& have) const {
  return BestScored(scored, candidates_, have, kMaxPromisingTerms, [](const Candidate& candidate) {
    return !candidate.known && !candidate.parameters.empty();
  });
}

void SetFitter::AddDraws(int candidate, int draws, const Vector& point, std::vector<Vector>& starts) const {
  const FitSetup setup = refitter_.SetupWith({candidate});
  Random random(Random::StreamSeed(options_.seed, static_cast<std::uint64_t>(candidate)));
  for (int draw = 0; draw < draws; ++draw) starts.push_back(DrawEffects(setup, point, random));
}

}  // namespace sinew::diagnosis
