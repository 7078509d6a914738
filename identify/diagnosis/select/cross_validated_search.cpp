#include "identify/diagnosis/select/cross_validated_search.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "base/random.h"
#include "identify/diagnosis/held_out_gain.h"
#include "identify/execution/executor.h"
#include "identify/role_view.h"

namespace sinew::diagnosis {
namespace {

constexpr double kStronglyAutocorrelated = 0.97;  // root of the noise ...
constexpr double kProcessOverInnovation = 5;      // ... and deviation over that of its innovations
constexpr double kTolerance = 1e-4;               // relative, of the cost, while searching ...
constexpr double kFineTolerance = 1e-6;           // ... and of the answer
constexpr std::size_t kMaxPromising = 10;
constexpr std::size_t kMaxLeftOut = 6;
constexpr int kDraws = 40;
// Fits take longer with more trials, and with many trials local searches end in poor local minima less often.
constexpr double kFewTrials = 6;
constexpr std::size_t kMaxSearched = 20;  // two in each fold
constexpr double kSpread = 0.8;
constexpr std::size_t kBeam = 2;  // sets that are extended, by each of the two errors
constexpr std::size_t kMaxSearchedCauses = 5;
constexpr double kMaxErrorRatio =
    0.97;  // largest error of left-out trials with a cause, as a share of that without it

template <class T>
bool ByLeftOut(const T& a, const T& b) {
  return a.left_out_error < b.left_out_error;
}

std::set<std::string> Searched(const Problem& problem) {
  const std::vector<std::string> all = TrainingTrials(problem);
  const std::size_t count = std::min(all.size(), kMaxSearched);
  std::set<std::string> some;
  for (std::size_t i = 0; i < count; ++i) some.insert(all[i * all.size() / count]);
  return some;
}

RoleView ViewOf(const Problem& problem, const std::set<std::string>& trials) {
  return RoleView(problem, [&](const Block& block) {
    const bool left = block.role == BlockRole::kTrain && trials.count(block.trial) == 0;
    return left ? BlockRole::kPredicted : block.role;
  });
}

CrossValidatedSearch::Set With(CrossValidatedSearch::Set set, int c) {
  set.insert(std::lower_bound(set.begin(), set.end(), c), c);
  return set;
}

}  // namespace

bool MisfitDominatesNoise(const noise::NoiseModel& noise) {
  return std::any_of(noise.channels.begin(), noise.channels.end(),
                     [](const noise::ChannelNoiseModel& channel) {
                       return channel.LargestRoot() > kStronglyAutocorrelated &&
                              channel.ProcessDeviation() > kProcessOverInnovation * channel.deviation;
                     });
}

CrossValidatedSearch::CrossValidatedSearch(const Problem& problem, const Refitter& refitter,
                                           const std::vector<Candidate>& candidates,
                                           const DiagnosisOptions& options)
    : problem_(problem),
      refitter_(refitter),
      candidates_(candidates),
      options_(options),
      searched_(ViewOf(problem, Searched(problem))) {
  folds_ = FoldsOf(searched_);
  const auto trials = static_cast<double>(TrainingTrials(searched_).size());
  restarts_ = static_cast<int>(kDraws * std::min(1.0, std::pow(kFewTrials / trials, 2)));
}

double CrossValidatedSearch::Rows() const {
  double rows = 0;
  for (const Block& block : searched_.layout()) rows += block.role == BlockRole::kTrain ? block.samples() : 0;
  return rows;
}

double CrossValidatedSearch::LeftOutError(const Set& released, const Vector& start) const {
  double squares = 0;
  for (const TrialFold& fold : folds_) {
    const RoleView view(searched_, [&](const Block& block) {
      if (block.role != BlockRole::kTrain) return BlockRole::kPredicted;
      return fold.Has(block.trial) ? BlockRole::kValidate : BlockRole::kTrain;
    });
    FitSetup setup = refitter_.SetupWith(released);
    setup.rest = start;
    std::vector<int> free;
    for (const int index : setup.free) {
      if (!fold.Has(setup.parameters[static_cast<std::size_t>(index)].trial)) free.push_back(index);
    }
    setup.free = std::move(free);
    const LeastSquares fit(view, setup);
    const auto found = FitFromStarts(fit, {start}, kTolerance);
    if (!found.failure.empty() || !std::isfinite(found.cost)) return std::numeric_limits<double>::infinity();
    const auto residuals = HeldOut(view).Residuals(fit.Parameters(found.x));
    if (!residuals) return std::numeric_limits<double>::infinity();
    for (const Vector& block : *residuals) squares += block.squaredNorm();
  }
  return std::sqrt(squares / Rows());
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

void CrossValidatedSearch::FitAll(std::vector<Trial>& trials,
                                  const std::vector<std::vector<Vector>>& starts) const {
  MakeExecutor(options_.threads)->ForEach(trials.size(), [&](std::size_t i, std::size_t) {
    Trial& trial = trials[i];
    trial.fitted_error = std::numeric_limits<double>::infinity();
    trial.left_out_error = std::numeric_limits<double>::infinity();
    FitSetup setup = refitter_.SetupWith(trial.released);
    setup.rest = starts[i].front();
    const LeastSquares fit(searched_, setup);
    const auto found = FitFromStarts(fit, starts[i], kTolerance);
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
    trials.push_back({std::move(next), {}, 0, 0});
    starts.push_back(RefitStarts(scored, candidates_, c));
  }
  FitAll(trials, starts);
  for (Trial& trial : trials) {
    if (std::isfinite(trial.fitted_error)) made.push_back(std::move(trial));
  }
}

// Local searches end in local minima: every set is fitted again from the values that the other sets found for
// the parameters they share, and from random points around its own solution.
void CrossValidatedSearch::Polish(const ScoredModel& base, std::vector<Trial>& sets) const {
  std::vector<Trial> again = sets;
  std::vector<std::vector<Vector>> starts(sets.size());
  const auto& parameters = base.refit.setup->parameters;
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
    Random random(Random::StreamSeed(options_.seed, i));
    for (int draw = 0; draw < restarts_; ++draw) {
      Vector start = sets[i].point;
      for (const int index : setup.free) {
        const Parameter& p = parameters[static_cast<std::size_t>(index)];
        if (p.kind == ParameterKind::kNuisance) continue;
        if (p.scale == Scale::kLog) {
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
  FitAll(again, starts);
  for (std::size_t i = 0; i < sets.size(); ++i) {
    if (again[i].fitted_error < sets[i].fitted_error) sets[i] = std::move(again[i]);
  }
}

void CrossValidatedSearch::LeaveOut(std::vector<Trial>& sets) const {
  MakeExecutor(options_.threads)->ForEach(sets.size(), [&](std::size_t i, std::size_t) {
    if (std::isfinite(sets[i].fitted_error))
      sets[i].left_out_error = LeftOutError(sets[i].released, sets[i].point);
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
    smaller.push_back({std::move(rest), {}, 0, 0});
    starts.push_back({std::move(start)});
  }
  FitAll(smaller, starts);
  LeaveOut(smaller);
  return smaller;
}

// Removes the causes that do not improve the prediction of left-out trials; the remaining ones are judged one
// by one.
Result<CrossValidatedSearch::Outcome> CrossValidatedSearch::Conclude(Trial best, double base_error) const {
  Outcome outcome;
  outcome.base_error = base_error;
  while (!best.released.empty()) {
    std::vector<Trial> smaller = OneLess(best);
    const auto least = std::min_element(smaller.begin(), smaller.end(), ByLeftOut<Trial>);
    if (best.released.size() > 1 && best.left_out_error > kMaxErrorRatio * least->left_out_error) {
      best = *least;
      continue;
    }
    for (std::size_t i = 0; i < smaller.size(); ++i)
      outcome.left_out_shares.emplace_back(best.released[i], best.left_out_error / smaller[i].left_out_error);
    break;
  }
  outcome.released = best.released;
  outcome.error = best.left_out_error;
  outcome.model = refitter_.FitOrdinary(best.released, {best.point}, kFineTolerance);
  if (!outcome.model.usable()) return Fail("{}", outcome.model.failure);
  outcome.misfit_still_dominates = MisfitDominatesNoise(outcome.model.noise);
  return outcome;
}

Result<CrossValidatedSearch::Outcome> CrossValidatedSearch::Run(const ScoredModel& base) {
  Trial nothing{{}, base.refit.point, 0, 0};
  nothing.left_out_error = LeftOutError({}, base.refit.point);
  const double base_error = nothing.left_out_error;
  Trial best = nothing;
  std::vector<Trial> beam{nothing};
  std::size_t without_gain = 0;
  for (std::size_t size = 1; size <= kMaxSearchedCauses && without_gain < 2; ++size) {
    std::vector<Trial> made;
    for (const Trial& from : beam) {
      if (from.released.empty()) {
        Grow(from, base, made);
        continue;
      }
      Refit refit = refitter_.FitOrdinary(from.released, {from.point}, kTolerance);
      if (!refit.usable()) continue;
      if (size == 2 && &from == &beam.front() && !MisfitDominatesNoise(refit.noise))
        return Conclude(from, base_error);
      SINEW_ASSIGN(const ScoredModel scored,
                   ScoreModel(problem_, candidates_, std::move(refit), options_.alarm_level, options_.seed));
      Grow(from, scored, made);
    }
    if (made.empty()) break;
    std::stable_sort(made.begin(), made.end(),
                     [](const Trial& a, const Trial& b) { return a.fitted_error < b.fitted_error; });
    if (made.size() > kMaxLeftOut) made.resize(kMaxLeftOut);
    Polish(base, made);
    LeaveOut(made);
    std::vector<Trial> by_left_out = made;
    std::stable_sort(by_left_out.begin(), by_left_out.end(), ByLeftOut<Trial>);
    beam.clear();
    for (std::size_t i = 0; i < std::min(kBeam, made.size()); ++i) {
      for (const Trial* one : {&by_left_out[i], &made[i]}) {
        const bool there = std::any_of(beam.begin(), beam.end(),
                                       [&](const Trial& b) { return b.released == one->released; });
        if (!there) beam.push_back(*one);
      }
    }
    if (options_.progress) {
      DiagnosisProgress progress{DiagnosisStep::kCrossValidate};
      progress.left_out_share = by_left_out.front().left_out_error / base_error;
      for (const int c : by_left_out.front().released)
        progress.effects.push_back(candidates_[static_cast<std::size_t>(c)].effect);
      options_.progress(progress);
    }
    ++without_gain;
    if (by_left_out.front().left_out_error < kMaxErrorRatio * best.left_out_error) {
      best = by_left_out.front();
      without_gain = 0;
    }
  }
  return Conclude(std::move(best), base_error);
}

}  // namespace sinew::diagnosis
