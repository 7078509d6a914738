#include "identify/diagnosis/select/cross_validated_search.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "base/random.h"
#include "identify/execution/executor.h"
#include "identify/keep_samples.h"

namespace sinew::diagnosis {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr double kTolerance = 1e-5;       // relative, of the cost, while searching ...
constexpr double kFineTolerance = 1e-7;   // ... and of the answer
constexpr double kRoughTolerance = 1e-2;  // ... before the sets of one size are shortened
constexpr std::size_t kContinued = 3;     // short searches that are continued to convergence
constexpr std::size_t kMaxPromising = 10;
constexpr std::size_t kMaxLeftOut = 6;  // sets of one size whose error of left-out data is found
constexpr int kDraws = 20;
constexpr std::size_t kDrawnSets = 3;  // of one size, those that fit best
constexpr int kMoreDraws = 40;         // for the answer
// Fits take longer with more trials, and with many trials local searches end in poor local minima less often.
constexpr double kFewTrials = 6;
constexpr std::size_t kMaxSearchedTrials = 20;  // two in each fold
constexpr int kMaxSearchedSamples = 6000;
constexpr double kSpread = 0.8;
constexpr std::size_t kBeam = 3;  // sets that are extended
constexpr std::size_t kMaxSearchedCauses = 6;
// Measured with a numerical prototype on 36 cases that chose them and 36 others: of the effects that matter
// 90 % are named, 97 % of the named ones are true.
constexpr double kNearBest = 1.25;         // error of the answer over the least one, at most
constexpr double kLeastGain = 0.85;        // error with a cause over that without it, at most ...
constexpr double kLeastGainedFolds = 0.6;  // ... and share of the folds in which it is smaller, at least
constexpr double kStillGains = 0.97;       // error over the best one before, for the search to go on
constexpr double kSubstitute = 1.05;       // error of a substitute over that of the answer, at most

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

CrossValidatedSearch::Set With(CrossValidatedSearch::Set set, int c) {
  set.insert(std::lower_bound(set.begin(), set.end(), c), c);
  return set;
}

double GeometricMean(const std::vector<double>& errors) {
  if (errors.empty()) return kInfinite;
  double sum = 0;
  for (const double error : errors) sum += std::log(std::max(error, std::numeric_limits<double>::min()));
  return std::exp(sum / static_cast<double>(errors.size()));
}

// By the error of left-out data; sets of the same error, as of an effect that changes nothing, by size.
template <class T>
bool IsBetter(const T& a, const T& b) {
  if (a.left_out_error != b.left_out_error) return a.left_out_error < b.left_out_error;
  return a.released.size() < b.released.size();
}

// Anywhere in the range of an effect's parameter, uniform in the logarithm of its size: at the null, and at a
// bound that is one, a local search may stay.
double AnywhereOf(const Parameter& p, Random& random) {
  constexpr double kDecades = 2;
  const double share = std::pow(10, -kDecades * random.Uniform());
  const bool up = p.lower >= p.null_value || (p.upper > p.null_value && random.Uniform() < 0.5);
  return p.null_value + share * ((up ? p.upper : p.lower) - p.null_value);
}

// Short searches from all starts; the best few are continued to convergence. @param continued more than one
// where the answer counts: a start in a wide basin is ahead at first
solvers::LocalFit::Outcome FitFromManyStarts(const LeastSquares& fit, const std::vector<Vector>& starts,
                                             double tolerance, std::size_t continued) {
  constexpr long kScoutEvaluations = 8;
  constexpr long kFitEvaluations = 80;
  solvers::LocalFit search(fit);
  std::vector<solvers::LocalFit::Outcome> scouts;
  for (const Vector& start : starts)
    scouts.push_back(search.Minimize(fit.Variables(start), -1, {0, tolerance}, kScoutEvaluations));
  std::stable_sort(scouts.begin(), scouts.end(),
                   [](const auto& a, const auto& b) { return a.cost < b.cost; });
  scouts.resize(std::min(scouts.size(), continued));
  for (auto& scout : scouts) {
    if (!std::isfinite(scout.cost) || scout.converged) continue;
    auto further = search.Minimize(scout.x, -1, {0, tolerance}, kFitEvaluations);
    if (further.failure.empty() && further.cost <= scout.cost) scout = std::move(further);
  }
  return *std::min_element(scouts.begin(), scouts.end(),
                           [](const auto& a, const auto& b) { return a.cost < b.cost; });
}

// Share of the folds in which the first has the smaller error.
double ShareOfFolds(const std::vector<double>& first, const std::vector<double>& second) {
  if (first.size() != second.size() || first.empty()) return 1;
  double smaller = 0;
  for (std::size_t i = 0; i < first.size(); ++i) smaller += first[i] < second[i] ? 1 : 0;
  return smaller / static_cast<double>(first.size());
}

}  // namespace

CrossValidatedSearch::CrossValidatedSearch(const Problem& problem, const Refitter& refitter,
                                           const std::vector<Candidate>& candidates, const MisfitScale& scale,
                                           const DiagnosisOptions& options)
    : problem_(problem),
      refitter_(refitter),
      candidates_(candidates),
      scale_(scale),
      options_(options),
      searched_(Searched(problem)),
      searched_refitter_(searched_, refitter.base(), candidates, options.interrupt),
      folds_(FoldsOf(searched_)) {
  const auto trials = static_cast<double>(TrainingTrials(searched_).size());
  draws_ = static_cast<int>(kDraws * std::min(1.0, std::pow(kFewTrials / trials, 2)));
}

double CrossValidatedSearch::Rows() const {
  double rows = 0;
  for (const Block& block : searched_.layout()) rows += block.role == BlockRole::kTrain ? block.samples() : 0;
  return rows;
}

std::vector<double> CrossValidatedSearch::LeftOutErrors(const Set& released, const Vector& start,
                                                        double tolerance) const {
  std::vector<double> errors;
  for (const Fold& fold : folds_) {
    const FoldView view(searched_, fold);
    FitSetup setup = WithoutLeftOut(refitter_.SetupWith(released), fold);
    setup.rest = start;
    const LeastSquares fit(view, setup);
    const auto found = FitFromStarts(fit, {start}, tolerance);
    if (!found.failure.empty() || !std::isfinite(found.cost)) return {};
    const auto residuals = LeftOutResiduals(searched_, fold, fit.Parameters(found.x));
    if (!residuals) return {};
    if (residuals->size() > 0)
      errors.push_back(residuals->norm() / std::sqrt(static_cast<double>(residuals->size())));
  }
  return errors;
}

double CrossValidatedSearch::LeftOutError(const Set& released, const Vector& start) const {
  return GeometricMean(LeftOutErrors(released, start, kTolerance));
}

// Candidates that all trials share, that are known, and that are among the best by the linear prediction.
std::vector<int> CrossValidatedSearch::Promising(const ScoredModel& scored, const Set& have) const {
  std::vector<std::pair<double, int>> ranking;
  for (std::size_t c = 0; c < candidates_.size(); ++c) {
    if (!candidates_[c].primary() || std::binary_search(have.begin(), have.end(), static_cast<int>(c)))
      continue;
    const Score* score = scored.BestOf(static_cast<int>(c), scored.plain);
    if (score != nullptr) ranking.emplace_back(-score->statistic, static_cast<int>(c));
  }
  std::sort(ranking.begin(), ranking.end());
  std::vector<int> promising;
  for (std::size_t i = 0; i < std::min(ranking.size(), kMaxPromising); ++i)
    promising.push_back(ranking[i].second);
  return promising;
}

void CrossValidatedSearch::FitAll(std::vector<Trial>& trials, const std::vector<std::vector<Vector>>& starts,
                                  double tolerance, std::size_t continued) const {
  MakeExecutor(options_.threads)->ForEach(trials.size(), [&](std::size_t i, std::size_t) {
    Trial& trial = trials[i];
    trial.fitted_error = kInfinite;
    trial.left_out_error = kInfinite;
    if (Interrupted()) return;
    FitSetup setup = refitter_.SetupWith(trial.released);
    setup.rest = starts[i].front();
    const LeastSquares fit(searched_, setup);
    const auto found = FitFromManyStarts(fit, starts[i], tolerance, continued);
    if (!found.failure.empty() || !std::isfinite(found.cost)) return;
    trial.point = fit.Parameters(found.x);
    trial.fitted_error = std::sqrt(2 * found.cost / Rows());
  });
}

void CrossValidatedSearch::Grow(const Trial& from, const ScoredModel& scored, std::vector<Trial>& made) {
  std::vector<Trial> trials;
  std::vector<std::vector<Vector>> starts;
  for (const int c : Promising(scored, from.released)) {
    Set next = With(from.released, c);
    if (!seen_.insert(next).second) continue;
    trials.push_back({std::move(next), {}, 0, 0, {}});
    starts.push_back(RefitStarts(scored, candidates_, c));
  }
  FitAll(trials, starts, kRoughTolerance, 1);
  for (Trial& trial : trials) {
    if (std::isfinite(trial.fitted_error)) made.push_back(std::move(trial));
  }
}

// Local searches end in local minima: every set is fitted again from the values that the other sets found for
// the parameters they share, and those that fit best also from random points around their own solution.
// @pre the sets are sorted by fitted error
void CrossValidatedSearch::Polish(std::vector<Trial>& sets, int draws) const {
  std::vector<Trial> again = sets;
  std::vector<std::vector<Vector>> starts(sets.size());
  const auto& parameters = refitter_.base().parameters;
  for (std::size_t i = 0; i < sets.size(); ++i) {
    const FitSetup setup = refitter_.SetupWith(sets[i].released);
    for (std::size_t other = 0; other < sets.size(); ++other) {
      if (other == i) continue;
      const FitSetup theirs = refitter_.SetupWith(sets[other].released);
      Vector start = sets[i].point;
      for (const int index : setup.free) {
        if (theirs.IsFree(index)) start[index] = sets[other].point[index];
      }
      starts[i].push_back(std::move(start));
    }
    for (const Trial& smaller : judged_) {
      const bool one_less = smaller.released.size() + 1 == sets[i].released.size() &&
                            std::includes(sets[i].released.begin(), sets[i].released.end(),
                                          smaller.released.begin(), smaller.released.end());
      if (!one_less) continue;
      // The parameters of the further cause as they are.
      const FitSetup theirs = refitter_.SetupWith(smaller.released);
      Vector start = smaller.point;
      for (const int index : setup.free) {
        if (!theirs.IsFree(index)) start[index] = sets[i].point[index];
      }
      starts[i].push_back(std::move(start));
      starts[i].push_back(smaller.point);
    }
    Random random(Random::StreamSeed(options_.seed, i));
    for (int draw = 0; i < kDrawnSets && draw < draws; ++draw) {
      Vector start = sets[i].point;
      for (const int index : setup.free) {
        const Parameter& p = parameters[static_cast<std::size_t>(index)];
        if (p.kind == ParameterKind::kNuisance) continue;
        if (p.kind == ParameterKind::kEffect && draw % 2 == 1) {
          start[index] = AnywhereOf(p, random);
        } else if (p.scale == Scale::kLog) {
          start[index] *= std::exp(kSpread * random.Normal());
        } else {
          const double size = std::max(std::abs(start[index] - p.null_value), 0.02 * (p.upper - p.lower));
          start[index] += kSpread * size * random.Normal();
        }
        start[index] = std::clamp(start[index], p.lower, p.upper);
      }
      starts[i].push_back(std::move(start));
    }
  }
  FitAll(again, starts, kTolerance, kContinued);
  for (std::size_t i = 0; i < sets.size(); ++i) {
    if (again[i].fitted_error < sets[i].fitted_error) sets[i] = std::move(again[i]);
  }
}

void CrossValidatedSearch::LeaveOut(std::vector<Trial>& sets, double tolerance) const {
  MakeExecutor(options_.threads)->ForEach(sets.size(), [&](std::size_t i, std::size_t) {
    if (!std::isfinite(sets[i].fitted_error) || Interrupted()) return;
    sets[i].fold_errors = LeftOutErrors(sets[i].released, sets[i].point, tolerance);
    sets[i].left_out_error = GeometricMean(sets[i].fold_errors);
  });
}

std::vector<CrossValidatedSearch::Trial> CrossValidatedSearch::OneLess(const Trial& of) const {
  std::vector<Trial> smaller;
  std::vector<std::vector<Vector>> starts;
  for (const int c : of.released) {
    Set rest;
    for (const int other : of.released) {
      if (other != c) rest.push_back(other);
    }
    Vector start = of.point;
    for (const int index : candidates_[static_cast<std::size_t>(c)].parameters)
      start[index] = refitter_.base().rest[index];
    starts.push_back({std::move(start)});
    // What the search found for this set, where it has been there.
    const auto known =
        std::find_if(judged_.begin(), judged_.end(), [&](const Trial& one) { return one.released == rest; });
    if (known != judged_.end()) starts.back().push_back(known->point);
    smaller.push_back({std::move(rest), {}, 0, 0, {}});
  }
  FitAll(smaller, starts, kTolerance, kContinued);
  LeaveOut(smaller, kTolerance);
  return smaller;
}

void CrossValidatedSearch::Consider(std::vector<Trial> made) {
  for (Trial& one : made) {
    if (std::isfinite(one.left_out_error)) judged_.push_back(std::move(one));
  }
}

CrossValidatedSearch::Trial CrossValidatedSearch::SimplestNearBest() const {
  const Trial& best = *std::min_element(judged_.begin(), judged_.end(), IsBetter<Trial>);
  const Trial* simplest = &best;
  for (const Trial& one : judged_) {
    if (one.left_out_error > kNearBest * best.left_out_error) continue;
    const std::size_t size = one.released.size();
    if (size < simplest->released.size() || (size == simplest->released.size() && IsBetter(one, *simplest)))
      simplest = &one;
  }
  return *simplest;
}

// Every cause replaced by what is promising without it.
Result<std::vector<CrossValidatedSearch::Substitute>> CrossValidatedSearch::FindSubstitutes(
    const Trial& of) const {
  std::vector<Trial> sets;
  std::vector<std::vector<Vector>> starts;
  std::vector<std::pair<int, int>> exchanged;  // cause, candidate
  for (const Trial& less : OneLess(of)) {
    if (!std::isfinite(less.fitted_error)) continue;
    Set cause;
    std::set_difference(of.released.begin(), of.released.end(), less.released.begin(), less.released.end(),
                        std::back_inserter(cause));
    Refit refit = searched_refitter_.FitOrdinary(less.released, {less.point}, kTolerance);
    if (!refit.usable()) continue;
    SINEW_ASSIGN(const ScoredModel scored,
                 ScoreModel(searched_, candidates_, std::move(refit), options_.alarm_level, options_.seed));
    for (const int c : Promising(scored, of.released)) {
      sets.push_back({With(less.released, c), {}, 0, 0, {}});
      starts.push_back(RefitStarts(scored, candidates_, c));
      exchanged.emplace_back(cause.front(), c);
    }
  }
  FitAll(sets, starts, kRoughTolerance, 1);
  std::vector<Substitute> found;
  std::vector<std::size_t> near;
  for (std::size_t i = 0; i < sets.size(); ++i) {
    // The fitted error is the smaller one: what is far off there is far off on left-out data, too.
    if (sets[i].fitted_error > kNearBest * of.fitted_error) sets[i].fitted_error = kInfinite;
  }
  LeaveOut(sets, kTolerance);
  for (std::size_t i = 0; i < sets.size(); ++i) {
    const double share = sets[i].left_out_error / of.left_out_error;
    if (!(share <= kSubstitute)) continue;
    Refit refit = refitter_.FitOrdinary(sets[i].released, {sets[i].point}, kFineTolerance);
    if (refit.usable()) found.push_back({exchanged[i].first, exchanged[i].second, share, std::move(refit)});
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const Substitute& a, const Substitute& b) { return a.error < b.error; });
  return found;
}

// Removes the causes without which left-out data are predicted nearly as well, or better in many folds.
CrossValidatedSearch::Trial CrossValidatedSearch::Pruned(Trial best, Shares& shares) const {
  while (!best.released.empty()) {
    const std::vector<Trial> smaller = OneLess(best);
    const Trial& least = *std::min_element(smaller.begin(), smaller.end(), IsBetter<Trial>);
    const bool needed = best.left_out_error <= kLeastGain * least.left_out_error &&
                        ShareOfFolds(best.fold_errors, least.fold_errors) >= kLeastGainedFolds;
    if (!needed) {
      best = least;
      continue;
    }
    for (std::size_t i = 0; i < smaller.size(); ++i)
      shares.emplace_back(best.released[i], best.left_out_error / smaller[i].left_out_error);
    break;
  }
  return best;
}

CrossValidatedSearch::Trial CrossValidatedSearch::Polished(Trial one, int draws) const {
  std::vector<Trial> again{one};
  Polish(again, draws);
  if (!(again.front().fitted_error < one.fitted_error)) return one;
  LeaveOut(again, kTolerance);
  return IsBetter(again.front(), one) ? again.front() : one;
}

Result<CrossValidatedSearch::Outcome> CrossValidatedSearch::Conclude(Trial best) {
  Outcome outcome;
  outcome.base_error = judged_.front().left_out_error;
  const int draws = draws_ > 0 ? kMoreDraws * draws_ / kDraws : 0;
  best = Polished(std::move(best), draws);
  best = Pruned(std::move(best), outcome.left_out_shares);
  best = Polished(std::move(best), draws);  // its fits began at those of larger sets
  for (const Trial& one : judged_) {
    const std::size_t size = one.released.size();
    if (outcome.ladder.size() <= size) outcome.ladder.resize(size + 1, {{}, kInfinite});
    if (one.left_out_error < outcome.ladder[size].error)
      outcome.ladder[size] = {one.released, one.left_out_error};
  }
  outcome.released = best.released;
  outcome.error = best.left_out_error;
  outcome.model = refitter_.FitOrdinary(best.released, {best.point}, kFineTolerance);
  if (!outcome.model.usable()) return Fail("{}", outcome.model.failure);
  outcome.misfit_still_dominates = scale_.Dominates(outcome.model.noise);
  if (outcome.misfit_still_dominates) {
    SINEW_ASSIGN(outcome.substitutes, FindSubstitutes(best));
  }
  return outcome;
}

// Keeps the sets that predict left-out data best, by fits that end early, and the one that fits best.
// @param made by fitted error
void CrossValidatedSearch::Shorten(std::vector<Trial>& made) const {
  if (made.size() <= kMaxLeftOut) return;
  LeaveOut(made, kRoughTolerance);
  std::stable_sort(made.begin() + 1, made.end(), IsBetter<Trial>);
  made.resize(kMaxLeftOut);
}

Result<CrossValidatedSearch::Outcome> CrossValidatedSearch::Run(const ScoredModel& base) {
  std::vector<Trial> nothing{{{}, base.refit.point, 0, kInfinite, {}}};
  LeaveOut(nothing, kTolerance);
  // Where the base model has no prediction of left-out data, sets cannot be compared in this way.
  if (!std::isfinite(nothing.front().left_out_error)) return Outcome();
  judged_ = nothing;
  std::vector<Trial> beam = nothing;
  double least = nothing.front().left_out_error;
  std::size_t without_gain = 0;
  for (std::size_t size = 1; size <= kMaxSearchedCauses && without_gain < 2; ++size) {
    std::vector<Trial> made;
    for (const Trial& from : beam) {
      if (from.released.empty()) {
        Grow(from, base, made);
        continue;
      }
      Refit refit = searched_refitter_.FitOrdinary(from.released, {from.point}, kTolerance);
      if (!refit.usable()) continue;
      SINEW_ASSIGN(const ScoredModel scored,
                   ScoreModel(searched_, candidates_, std::move(refit), options_.alarm_level, options_.seed));
      Grow(from, scored, made);
    }
    if (made.empty()) break;
    std::stable_sort(made.begin(), made.end(),
                     [](const Trial& a, const Trial& b) { return a.fitted_error < b.fitted_error; });
    if (size == 1) {
      const Refit one = refitter_.FitOrdinary(made.front().released, {made.front().point}, kTolerance);
      if (one.usable() && scale_.Resembles(one.noise)) {
        made.resize(1);
        LeaveOut(made, kTolerance);
        Consider(made);
        return Conclude(made.front());
      }
    }
    Shorten(made);
    Polish(made, draws_);
    LeaveOut(made, kTolerance);
    std::stable_sort(made.begin(), made.end(), IsBetter<Trial>);
    Consider(made);
    beam.assign(made.begin(), made.begin() + static_cast<std::ptrdiff_t>(std::min(kBeam, made.size())));
    // One that fits best may need another cause before it predicts well.
    const auto fits_best = std::min_element(made.begin(), made.end(), [](const Trial& a, const Trial& b) {
      return a.fitted_error < b.fitted_error;
    });
    if (static_cast<std::size_t>(fits_best - made.begin()) >= kBeam) beam.push_back(*fits_best);
    if (options_.progress) {
      DiagnosisProgress progress{DiagnosisStep::kCrossValidate};
      progress.left_out_share = made.front().left_out_error / nothing.front().left_out_error;
      for (const int c : made.front().released)
        progress.effects.push_back(candidates_[static_cast<std::size_t>(c)].effect);
      options_.progress(progress);
    }
    ++without_gain;
    if (made.front().left_out_error < kStillGains * least) without_gain = 0;
    least = std::min(least, made.front().left_out_error);
  }
  return Conclude(SimplestNearBest());
}

}  // namespace sinew::diagnosis
