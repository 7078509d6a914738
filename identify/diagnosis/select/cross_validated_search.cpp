#include "identify/diagnosis/select/cross_validated_search.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "base/random.h"
#include "identify/diagnosis/select/choice_of_sets.h"
#include "identify/diagnosis/select/many_starts.h"
#include "identify/execution/shared_loop.h"
#include "identify/keep_samples.h"

namespace sinew::diagnosis {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr double kTolerance = 1e-5;       // relative, of the cost, while searching ...
constexpr double kFineTolerance = 1e-7;   // ... and of the answer
constexpr double kRoughTolerance = 1e-2;  // ... before the sets of one size are shortened
constexpr std::size_t kContinued = 3;     // short searches that are continued to convergence
constexpr std::size_t kMaxPromising = 10;
constexpr std::size_t kMaxLeftOut = 6;          // sets of one size whose error of left-out data is found
constexpr std::size_t kMaxRoughlyLeftOut = 16;  // ... by fits that end early
constexpr int kDraws = 20;
constexpr int kMoreDraws = 6;          // of another cause beside those of the answer
constexpr int kGrownDraws = 3;         // of a set that is made, besides the linear prediction
constexpr std::size_t kDrawnSets = 3;  // of one size, those that fit best
constexpr std::size_t kGroups = 4;     // of starts of the answer, each by one thread
constexpr int kMaxRounds = 8;          // of starts around the best solution of the answer so far ...
constexpr int kIdleRounds = 2;         // ... until so many have found none ...
constexpr double kLower = 0.999;       // ... with a fitted error below this share
// Fits take longer with more trials, and with many trials local searches end in poor local minima less often.
constexpr double kFewTrials = 6;
constexpr std::size_t kMaxSearchedTrials = 20;  // two in each fold
constexpr int kMaxSearchedSamples = 6000;
constexpr std::size_t kBeam = 3;  // sets that are extended
constexpr std::size_t kMaxSearchedCauses = 6;
constexpr std::size_t kMostCauses = 8;  // of the answer
constexpr std::size_t kMaxChoices = 8;  // of a set, each after further fits around it; mostly 2 to 4
constexpr double kStillGains = 0.97;    // error over the best one before, for the search to go on
constexpr double kSubstitute = 1.05;    // error of a substitute over that of the answer, at most
constexpr double kFarOff = 1.25;        // fitted error of what is no substitute over that of the answer

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

bool IsOneLess(const CrossValidatedSearch::Set& smaller, const CrossValidatedSearch::Set& set) {
  return smaller.size() + 1 == set.size() &&
         std::includes(set.begin(), set.end(), smaller.begin(), smaller.end());
}

// @pre IsOneLess
int CauseBeyond(const CrossValidatedSearch::Set& smaller, const CrossValidatedSearch::Set& set) {
  return *std::mismatch(smaller.begin(), smaller.end(), set.begin()).second;
}

// By the error of left-out data; sets of the same error, as of an effect that changes nothing, by size.
template <class T>
bool IsBetter(const T& a, const T& b) {
  if (a.left_out_error != b.left_out_error) return a.left_out_error < b.left_out_error;
  return a.released.size() < b.released.size();
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
    const auto residuals = LeftOutResiduals(searched_, fold, fit.Parameters(found.x), setup.record);
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
  ForEachShared(options_.record, options_.threads, trials.size(), [&](std::size_t i, std::size_t) {
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

// Starts at `point` with the candidate's parameters anywhere.
void CrossValidatedSearch::AddDraws(int candidate, int draws, const Vector& point,
                                    std::vector<Vector>& starts) const {
  const FitSetup setup = refitter_.SetupWith({candidate});
  Random random(Random::StreamSeed(options_.seed, static_cast<std::uint64_t>(candidate)));
  for (int draw = 0; draw < draws; ++draw) starts.push_back(DrawEffects(setup, point, random));
}

void CrossValidatedSearch::Grow(const Trial& from, const ScoredModel& scored, std::vector<Trial>& made) {
  std::vector<Trial> trials;
  std::vector<std::vector<Vector>> starts;
  for (const int c : Promising(scored, from.released)) {
    Set next = With(from.released, c);
    if (!seen_.insert(next).second) continue;
    trials.push_back({std::move(next), {}, 0, 0, {}});
    starts.push_back(RefitStarts(scored, candidates_, c));
    // The linear prediction may start in the wrong basin: backlash beside a delay that has taken its place.
    AddDraws(c, kGrownDraws, from.point, starts.back());
  }
  FitAll(trials, starts, kRoughTolerance, 1);
  for (Trial& trial : trials) {
    if (std::isfinite(trial.fitted_error)) made.push_back(std::move(trial));
  }
}

// Local searches end in local minima: every set is fitted again from the values that the other sets found for
// the parameters they share, and those that fit best also from random points around their own solution.
// @pre the sets are sorted by fitted error
void CrossValidatedSearch::Polish(std::vector<Trial>& sets) const {
  std::vector<Trial> again = sets;
  std::vector<std::vector<Vector>> starts(sets.size());
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
      if (!IsOneLess(smaller.released, sets[i].released)) continue;
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
    for (int draw = 0; i < kDrawnSets && draw < draws_; ++draw)
      starts[i].push_back(DrawStart(setup, sets[i].point, draw, random));
  }
  FitAll(again, starts, kTolerance, kContinued);
  for (std::size_t i = 0; i < sets.size(); ++i) {
    if (again[i].fitted_error < sets[i].fitted_error) sets[i] = std::move(again[i]);
  }
}

void CrossValidatedSearch::LeaveOut(std::vector<Trial>& sets, double tolerance) const {
  ForEachShared(options_.record, options_.threads, sets.size(), [&](std::size_t i, std::size_t) {
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

// Of fits of the same set, the one that predicts left-out data better.
void CrossValidatedSearch::Consider(std::vector<Trial> made) {
  for (Trial& one : made) {
    if (!std::isfinite(one.left_out_error)) continue;
    const auto known = std::find_if(judged_.begin(), judged_.end(),
                                    [&](const Trial& other) { return other.released == one.released; });
    if (known == judged_.end()) {
      judged_.push_back(std::move(one));
    } else if (IsBetter(one, *known)) {
      *known = std::move(one);
    }
  }
}

// What the choice depends on, of every set that was judged.
std::vector<JudgedSet> CrossValidatedSearch::Judged() const {
  std::vector<JudgedSet> sets;
  for (const Trial& one : judged_) {
    JudgedSet set{one.released, one.fold_errors};
    for (const int index : refitter_.base().free) {
      const Parameter& p = refitter_.base().parameters[static_cast<std::size_t>(index)];
      const double value = one.point[index];
      if (p.kind == ParameterKind::kBase && (value <= p.lower || value >= p.upper)) ++set.at_bound;
    }
    for (const int c : one.released)
      set.rarity += static_cast<int>(candidates_[static_cast<std::size_t>(c)].occurrence);
    sets.push_back(std::move(set));
  }
  return sets;
}

bool CrossValidatedSearch::LeavesOnlyNoise(const Trial& one) const {
  if (!std::isfinite(one.fitted_error)) return false;
  const Refit refit = refitter_.FitOrdinary(one.released, {one.point}, kTolerance);
  return refit.usable() && scale_.IsNoMore(refit.noise);
}

// Judges the sets that fit nearly as well as the best one.
void CrossValidatedSearch::EndWith(std::vector<Trial> made) {
  std::stable_sort(made.begin(), made.end(),
                   [](const Trial& a, const Trial& b) { return a.fitted_error < b.fitted_error; });
  const double most = kFarOff * made.front().fitted_error;
  std::size_t near = 1;
  while (near < std::min(made.size(), kMaxLeftOut) && made[near].fitted_error <= most) ++near;
  made.resize(near);
  LeaveOut(made, kTolerance);
  Consider(std::move(made));
}

// How firm the choice is: sets by the share of resamples of the folds in which they are chosen.
void CrossValidatedSearch::Resample(Outcome& outcome) const {
  const std::vector<double> shares = ChosenShares(Judged(), options_.seed);
  std::vector<double> of_candidates(candidates_.size(), 0);
  for (std::size_t k = 0; k < judged_.size(); ++k) {
    if (shares[k] == 0) continue;
    outcome.resampled.push_back({judged_[k].released, judged_[k].point, shares[k]});
    for (const int c : judged_[k].released) of_candidates[static_cast<std::size_t>(c)] += shares[k];
  }
  for (std::size_t c = 0; c < candidates_.size(); ++c) {
    if (of_candidates[c] > 0) outcome.chosen_shares.emplace_back(static_cast<int>(c), of_candidates[c]);
  }
}

// Every cause replaced by what is promising without it.
Result<std::vector<CrossValidatedSearch::Substitute>> CrossValidatedSearch::FindSubstitutes(
    const Trial& of) const {
  std::vector<Trial> sets;
  std::vector<std::vector<Vector>> starts;
  std::vector<std::pair<int, int>> exchanged;  // cause, candidate
  for (const Trial& less : OneLess(of)) {
    if (!std::isfinite(less.fitted_error)) continue;
    Refit refit = searched_refitter_.FitOrdinary(less.released, {less.point}, kTolerance);
    if (!refit.usable()) continue;
    SINEW_ASSIGN(const ScoredModel scored,
                 ScoreModel(searched_, candidates_, std::move(refit), options_.alarm_level, options_.seed));
    for (const int c : Promising(scored, of.released)) {
      sets.push_back({With(less.released, c), {}, 0, 0, {}});
      starts.push_back(RefitStarts(scored, candidates_, c));
      exchanged.emplace_back(CauseBeyond(less.released, of.released), c);
    }
  }
  FitAll(sets, starts, kRoughTolerance, 1);
  std::vector<Substitute> found;
  for (std::size_t i = 0; i < sets.size(); ++i) {
    // The fitted error is the smaller one: what is far off there is far off on left-out data, too.
    if (sets[i].fitted_error > kFarOff * of.fitted_error) sets[i].fitted_error = kInfinite;
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

// Rounds of random starts around the best solution so far (basin hopping: Wales, Doye 1997, J. Phys. Chem. A
// 101:5111-5116), so that the answer does not depend on where the search came from.
CrossValidatedSearch::Trial CrossValidatedSearch::Polished(Trial one) const {
  if (LeavesOnlyNoise(one)) return one;
  const FitSetup setup = refitter_.SetupWith(one.released);
  const int draws = (draws_ + static_cast<int>(kGroups) - 1) / static_cast<int>(kGroups);
  Trial best = one;
  int idle = 0;
  for (int round = 0; draws > 0 && round < kMaxRounds && idle < kIdleRounds && !Interrupted(); ++round) {
    std::vector<Trial> groups(kGroups, best);
    std::vector<std::vector<Vector>> starts(kGroups);
    for (std::size_t g = 0; g < kGroups; ++g) {
      Random random(Random::StreamSeed(options_.seed, static_cast<std::size_t>(round) * kGroups + g));
      for (int draw = 0; draw < draws; ++draw)
        starts[g].push_back(DrawStart(setup, best.point, static_cast<int>(g) + 2 * draw, random));
    }
    FitAll(groups, starts, kTolerance, 1);
    const auto lowest = std::min_element(groups.begin(), groups.end(), [](const Trial& a, const Trial& b) {
      return a.fitted_error < b.fitted_error;
    });
    idle = lowest->fitted_error < kLower * best.fitted_error ? 0 : idle + 1;
    if (lowest->fitted_error < best.fitted_error) best = *lowest;
  }
  if (!(best.fitted_error < one.fitted_error)) return one;
  std::vector<Trial> judged{std::move(best)};
  LeaveOut(judged, kTolerance);
  return IsBetter(judged.front(), one) ? judged.front() : one;
}

// Sets with another cause each, from more starts than while the sets grow: with the right causes a model that
// lacks one may have taken values from which no search leads on. None where no more than noise is left.
Result<std::vector<CrossValidatedSearch::Trial>> CrossValidatedSearch::OneMore(const Trial& of) const {
  std::vector<Trial> larger;
  Refit refit = searched_refitter_.FitOrdinary(of.released, {of.point}, kTolerance);
  if (!refit.usable() || of.released.size() >= kMostCauses || scale_.Resembles(refit.noise)) return larger;
  SINEW_ASSIGN(const ScoredModel scored,
               ScoreModel(searched_, candidates_, std::move(refit), options_.alarm_level, options_.seed));
  std::vector<std::vector<Vector>> starts;
  for (const int c : Promising(scored, of.released)) {
    larger.push_back({With(of.released, c), {}, 0, 0, {}});
    starts.push_back(RefitStarts(scored, candidates_, c));
    AddDraws(c, kMoreDraws, of.point, starts.back());
  }
  FitAll(larger, starts, kTolerance, kContinued);
  std::stable_sort(larger.begin(), larger.end(),
                   [](const Trial& a, const Trial& b) { return a.fitted_error < b.fitted_error; });
  larger.resize(std::min(larger.size(), kMaxLeftOut));
  LeaveOut(larger, kTolerance);
  return larger;
}

// A set is the answer once it, and the sets with one of its causes less or another one more, have been fitted
// from many starts.
Result<CrossValidatedSearch::Trial> CrossValidatedSearch::Choose(Shares& shares) {
  std::set<Set> completed;
  for (;;) {
    const Trial chosen = judged_[ChooseSet(Judged())];
    if (!completed.insert(chosen.released).second || completed.size() > kMaxChoices || Interrupted()) {
      shares.clear();
      for (const Trial& less : judged_) {
        if (IsOneLess(less.released, chosen.released))
          shares.emplace_back(CauseBeyond(less.released, chosen.released),
                              chosen.left_out_error / less.left_out_error);
      }
      return chosen;
    }
    const Trial polished = Polished(chosen);
    Consider({polished});
    Consider(OneLess(polished));
    SINEW_ASSIGN(std::vector<Trial> larger, OneMore(polished));
    Consider(std::move(larger));
  }
}

Result<CrossValidatedSearch::Outcome> CrossValidatedSearch::Conclude() {
  Outcome outcome;
  outcome.base_error = judged_.front().left_out_error;
  SINEW_ASSIGN(const Trial best, Choose(outcome.left_out_shares));
  Resample(outcome);
  for (const Trial& one : judged_) {
    outcome.judged.push_back({one.released, one.left_out_error});
    const std::size_t size = one.released.size();
    if (outcome.ladder.size() <= size) outcome.ladder.resize(size + 1, {{}, kInfinite});
    if (one.left_out_error < outcome.ladder[size].error)
      outcome.ladder[size] = {one.released, one.left_out_error};
  }
  outcome.released = best.released;
  outcome.error = best.left_out_error;
  outcome.model = refitter_.FitOrdinary(best.released, {best.point}, kFineTolerance);
  if (!outcome.model.usable()) return Fail("{}", outcome.model.failure);
  outcome.misfit_left = !scale_.Resembles(outcome.model.noise);
  if (outcome.misfit_left) {
    SINEW_ASSIGN(outcome.substitutes, FindSubstitutes(best));
  }
  return outcome;
}

// Keeps the sets that predict left-out data best, by fits that end early, and the one that fits best.
// @param made by fitted error
void CrossValidatedSearch::Shorten(std::vector<Trial>& made) const {
  if (made.size() <= kMaxLeftOut) return;
  made.resize(std::min(made.size(), kMaxRoughlyLeftOut));
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
        return Conclude();
      }
    }
    // Sets of one cause more cannot leave clearly less, and neither can other starts of these.
    if (LeavesOnlyNoise(made.front())) {
      EndWith(std::move(made));
      return Conclude();
    }
    Shorten(made);
    Polish(made);
    const auto lowest = std::min_element(made.begin(), made.end(), [](const Trial& a, const Trial& b) {
      return a.fitted_error < b.fitted_error;
    });
    if (LeavesOnlyNoise(*lowest)) {
      EndWith(std::move(made));
      return Conclude();
    }
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
  return Conclude();
}

}  // namespace sinew::diagnosis
