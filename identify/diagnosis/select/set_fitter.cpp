#include "identify/diagnosis/select/set_fitter.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include "base/random.h"
#include "identify/diagnosis/select/choice_of_sets.h"
#include "identify/diagnosis/select/imitating_sets.h"
#include "identify/diagnosis/select/many_starts.h"
#include "identify/execution/executor.h"
#include "identify/execution/shared_loop.h"
#include "identify/keep_samples.h"
#include "identify/solvers/alternating_fit.h"
#include "identify/solvers/probed_start.h"

namespace sinew::diagnosis {
namespace {

constexpr std::size_t kMaxPromising = 10;
constexpr std::size_t kMaxPromisingTerms = 4;
constexpr int kDraws = 20;
// Fits take longer with more trials, and with many trials local searches end in poor local minima less often.
constexpr double kFewTrials = 6;
constexpr std::size_t kMaxSearchedTrials = 20;  // two in each fold
constexpr int kMaxSearchedSamples = 6000;
constexpr long kFoldEvaluations = 80;      // of a fit without a fold ...
constexpr long kRoughFoldEvaluations = 8;  // ... a few steps: most of the way
constexpr std::size_t kManyProbes = 13;    // values of an effect of which the scores single out too few
constexpr double kClearlyLower = 0.995;    // error after an alternating fit over that before
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

// The search was built and measured with straight steps; curved ones lead to other sets (docs/decisions).
FitSetup Straight(FitSetup setup) {
  setup.straight_steps = true;
  return setup;
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

// All parts of all sets in one loop, so that threads and ranks have work until the end. After an interruption
// the rest is left out.
void SetFitter::ForEachPart(std::size_t sets, const std::function<std::size_t(std::size_t)>& parts,
                            const std::function<void(std::size_t, std::size_t)>& work) const {
  std::vector<std::pair<std::size_t, std::size_t>> all;
  for (std::size_t i = 0; i < sets; ++i) {
    for (std::size_t part = 0; part < parts(i); ++part) all.emplace_back(i, part);
  }
  ForEachShared(options_.record, options_.threads, all.size(), [&](std::size_t k, std::size_t) {
    if (!Interrupted()) work(all[k].first, all[k].second);
  });
}

bool PredictsBetter(const FittedSet& a, const FittedSet& b) {
  if (a.left_out_error != b.left_out_error) return a.left_out_error < b.left_out_error;
  return a.released.size() < b.released.size();
}

bool FitsBetter(const FittedSet& a, const FittedSet& b) {
  return a.fitted_error < b.fitted_error;
}

SetFitter::SetFitter(const Problem& problem, const Refitter& refitter,
                     const std::vector<Candidate>& candidates, const DiagnosisOptions& options,
                     ScoredCandidates scored)
    : refitter_(refitter),
      candidates_(candidates),
      options_(options),
      searched_(Searched(problem)),
      searched_refitter_(searched_, Straight(refitter.base()), candidates, options.interrupt),
      folds_(FoldsOf(searched_)),
      scored_(scored) {
  const auto trials = static_cast<double>(TrainingTrials(searched_).size());
  draws_ = static_cast<int>(kDraws * std::min(1.0, std::pow(kFewTrials / trials, 2)));
}

FitSetup SetFitter::SetupWith(const std::vector<int>& released) const {
  return Straight(refitter_.SetupWith(released));
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

// A fit without a fold, and the error of what that leaves out.
// @param all as released, at the point from which the fit starts @param norms ColumnNorms of it
// @param before [P] where a fit without the fold ended before, may be null
Result<SetFitter::LeftOut> SetFitter::LeaveOutFold(const FitSetup& all, const Vector& norms, const Fold& fold,
                                                   const Vector* before, const Effort& effort) const {
  const FoldView view(searched_, fold);
  const FitSetup setup = WithTiedNuisance(WithoutLeftOut(all, fold), fold, norms, all.rest);
  const LeastSquares fit(view, setup);
  const Vector here = fit.Variables(all.rest);
  solvers::LocalFit search(fit);
  const auto found = search.Minimize(before == nullptr ? here : LowerOf(fit, here, fit.Variables(*before)),
                                     -1, {0, effort.tolerance}, effort.evaluations);
  if (!found.failure.empty()) return Fail("{}", found.failure);
  if (!std::isfinite(found.cost)) return Fail("the fit has no cost");
  LeftOut out{{}, fit.Parameters(found.x)};
  SINEW_ASSIGN(const Vector residuals, LeftOutResiduals(searched_, fold, out.point, setup.record));
  if (residuals.size() > 0) out.error = residuals.norm() / std::sqrt(static_cast<double>(residuals.size()));
  return out;
}

void SetFitter::Fit(std::vector<FittedSet>& sets, const std::vector<std::vector<Vector>>& starts,
                    double tolerance, std::size_t continued) const {
  struct Search {
    FitSetup setup;
    std::optional<LeastSquares> fit;
    std::optional<ManyStarts> from;
  };
  std::vector<Search> searches(sets.size());
  for (std::size_t i = 0; i < sets.size(); ++i) {
    sets[i].fitted_error = std::numeric_limits<double>::infinity();
    sets[i].left_out_error = sets[i].fitted_error;
    Search& search = searches[i];
    search.setup = SetupWith(sets[i].released);
    search.setup.rest = starts[i].front();
    search.fit.emplace(searched_, search.setup);
    search.from.emplace(*search.fit, starts[i], tolerance, continued);
  }
  ForEachPart(
      sets.size(), [&](std::size_t i) { return searches[i].from->starts(); },
      [&](std::size_t i, std::size_t start) { searches[i].from->Search(start); });
  if (Interrupted()) return;
  for (Search& search : searches) search.from->Shorten();
  ForEachPart(
      sets.size(), [&](std::size_t i) { return searches[i].from->left(); },
      [&](std::size_t i, std::size_t one) { searches[i].from->Continue(one); });
  if (Interrupted()) return;
  for (std::size_t i = 0; i < sets.size(); ++i) {
    const auto& found = searches[i].from->Best();
    if (!found.failure.empty() || !std::isfinite(found.cost)) continue;
    sets[i].point = searches[i].fit->Parameters(found.x);
    sets[i].fitted_error = std::sqrt(2 * found.cost / Rows());
  }
}

void SetFitter::FitFromProbes(std::vector<FittedSet>& sets) const {
  const auto stop = [&] { return Interrupted(); };
  const auto has_many_probes = [&](int c) {
    return candidates_[static_cast<std::size_t>(c)].probes.size() >= kManyProbes;
  };
  ForEachShared(options_.record, options_.threads, sets.size(), [&](std::size_t i, std::size_t) {
    FittedSet& one = sets[i];
    if (std::none_of(one.released.begin(), one.released.end(), has_many_probes)) return;
    if (stop() || !std::isfinite(one.fitted_error)) return;
    FitSetup setup = SetupWith(one.released);
    setup.rest = one.point;
    LeastSquares fit(searched_, setup);
    const Vector x = fit.Variables(one.point);
    auto found = solvers::AlternatingFit(fit, x, {0, kTolerance}, stop);
    const Vector probed = solvers::ProbedStart(fit, x, {stop, {}, kManyProbes});
    if (probed != x && !stop()) {
      auto other = solvers::AlternatingFit(fit, probed, {0, kTolerance}, stop);
      if (other.failure.empty() && !(found.failure.empty() && found.cost <= other.cost))
        found = std::move(other);
    }
    const double error = std::sqrt(2 * found.cost / Rows());
    if (!found.failure.empty() || !(error < kClearlyLower * one.fitted_error)) return;
    one = FittedSet(one.released);
    one.point = fit.Parameters(found.x);
    one.fitted_error = error;
    one.left_out_error = std::numeric_limits<double>::infinity();
  });
}

void SetFitter::LeaveOut(std::vector<FittedSet>& sets) const {
  LeaveOutWith({kTolerance, kFoldEvaluations}, sets);
}

void SetFitter::LeaveOutRoughly(std::vector<FittedSet>& sets) const {
  LeaveOutWith({kRoughTolerance, kRoughFoldEvaluations}, sets);
}

void SetFitter::LeaveOutWith(const Effort& effort, std::vector<FittedSet>& sets) const {
  std::vector<std::size_t> fitted;
  std::vector<FitSetup> setups;
  for (std::size_t i = 0; i < sets.size(); ++i) {
    if (!std::isfinite(sets[i].fitted_error)) continue;
    sets[i].fold_errors.clear();
    sets[i].left_out_error = std::numeric_limits<double>::infinity();
    fitted.push_back(i);
    setups.push_back(SetupWith(sets[i].released));
    setups.back().rest = sets[i].point;
  }
  std::vector<Vector> norms(fitted.size());
  MakeExecutor(options_.threads)->ForEach(fitted.size(), [&](std::size_t k, std::size_t) {
    norms[k] = ColumnNorms(setups[k]);
  });
  std::vector<std::vector<Result<LeftOut>>> folds(fitted.size(), std::vector<Result<LeftOut>>(folds_.size()));
  ForEachPart(
      fitted.size(), [&](std::size_t) { return folds_.size(); },
      [&](std::size_t k, std::size_t f) {
        const std::vector<Vector>& before = sets[fitted[k]].fold_points;
        folds[k][f] =
            LeaveOutFold(setups[k], norms[k], folds_[f], before.empty() ? nullptr : &before[f], effort);
      });
  if (Interrupted()) return;
  for (std::size_t k = 0; k < fitted.size(); ++k) {
    FittedSet& one = sets[fitted[k]];
    one.fold_points.clear();
    if (!std::all_of(folds[k].begin(), folds[k].end(), [](const auto& fold) { return fold.has_value(); }))
      continue;
    for (Result<LeftOut>& fold : folds[k]) {
      if (fold->error) one.fold_errors.push_back(*fold->error);
      one.fold_points.push_back(std::move(fold->point));
    }
    one.left_out_error = GeometricMean(one.fold_errors);
  }
}

// @param starts the point with the member at its null is added
FittedSet SetFitter::WithoutMember(const FittedSet& of, int c, std::vector<Vector>& starts) const {
  Vector start = of.point;
  for (const int index : candidates_[static_cast<std::size_t>(c)].parameters)
    start[index] = refitter_.base().rest[index];
  starts.push_back(std::move(start));
  return FittedSet(Without(of.released, c));
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
  LeaveOut(near);
  for (std::size_t k = 0; k < near.size(); ++k) smaller[index[k]] = std::move(near[k]);
  return smaller;
}

FittedSet SetFitter::WithoutIdle(const FittedSet& of) const {
  FittedSet rest = of;
  for (const int c : of.released) {
    FitSetup setup = SetupWith(Without(rest.released, c));
    setup.rest = rest.point;
    for (const int index : candidates_[static_cast<std::size_t>(c)].parameters)
      setup.rest[index] = refitter_.base().rest[index];
    const LeastSquares fit(searched_, setup);
    auto workspace = fit.NewWorkspace();
    const auto cost = fit.Cost(fit.Variables(setup.rest), workspace);
    if (!cost) continue;
    const double error = std::sqrt(2 * *cost / Rows());
    if (!(error <= (1 + kIdle) * of.fitted_error)) continue;
    rest = FittedSet(Without(rest.released, c));
    rest.point = setup.rest;
    rest.fitted_error = error;
  }
  return rest;
}

Vector SetFitter::Continued(const FittedSet& of, int c) const {
  FitSetup setup = SetupWith(Without(of.released, c));
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
  LeaveOut(smaller);
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

Result<std::map<std::vector<int>, std::vector<Vector>>> SetFitter::ImitatingSets(const FittedSet& of) const {
  if (of.released.size() < 2) return std::map<std::vector<int>, std::vector<Vector>>();
  const Refit refit = searched_refitter_.FitOrdinary(of.released, {of.point}, kTolerance);
  if (!refit.usable()) return std::map<std::vector<int>, std::vector<Vector>>();
  return FindImitatingSets(searched_, candidates_, refit, base().rest);
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
  const FitSetup setup = SetupWith({candidate});
  Random random(Random::StreamSeed(options_.seed, static_cast<std::uint64_t>(candidate)));
  for (int draw = 0; draw < draws; ++draw) starts.push_back(DrawEffects(setup, point, random));
}

}  // namespace sinew::diagnosis
