#include "identify/diagnosis/select/cross_validated_search.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <string>

#include "identify/diagnosis/select/further_fits.h"

namespace sinew::diagnosis {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr double kTolerance = SetFitter::kTolerance;
constexpr double kFineTolerance = 1e-7;  // of the answer
constexpr double kRoughTolerance = SetFitter::kRoughTolerance;
constexpr std::size_t kContinued = SetFitter::kContinued;
constexpr std::size_t kMaxLeftOut = 6;          // sets of one size whose error of left-out data is found
constexpr std::size_t kMaxRoughlyLeftOut = 16;  // ... by fits that end early
constexpr int kMoreDraws = 6;                   // of another cause beside those of the answer
constexpr int kGrownDraws = 3;                  // of a set that is made, besides the linear prediction
constexpr std::size_t kBeam = 3;                // sets that are extended
constexpr std::size_t kMaxSearchedCauses = 8;
constexpr std::size_t kIdleGrowths = 3;  // without a gain, before the search ends
constexpr int kMaxGrowths = 16;          // mostly as many as there are causes, and two
constexpr std::size_t kMostCauses = 8;   // of the answer
constexpr std::size_t kMaxChoices = 8;   // of a set, each after further fits around it; mostly 2 to 4
constexpr double kStillGains = 0.85;     // error over the best one before, for the search to go on
constexpr std::size_t kShrunk = 3;       // size from which causes are taken out again ...
constexpr double kShrunkGains = 0.97;    // ... to an error over the least one of the size before, at most
constexpr double kFarOff = 1.25;  // error over that of the best set, from which a set needs no further look
constexpr std::size_t kPolishedOthers = 3;  // sets with another effect in the place of a cause

// Those whose fit did not fail and was not interrupted, by fitted error.
std::vector<FittedSet> BestFitted(std::vector<FittedSet> sets) {
  sets.erase(std::remove_if(sets.begin(), sets.end(),
                            [](const FittedSet& one) { return !std::isfinite(one.fitted_error); }),
             sets.end());
  std::stable_sort(sets.begin(), sets.end(), FitsBetter);
  return sets;
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
      fitter_(problem, refitter, candidates, options),
      judged_(refitter, candidates) {}

bool CrossValidatedSearch::LeavesOnlyNoise(const FittedSet& one) const {
  if (!std::isfinite(one.fitted_error)) return false;
  const Refit refit = refitter_.FitOrdinary(one.released, {one.point}, kTolerance);
  return refit.usable() && scale_.At(refit).IsNoMore(refit.noise);
}

bool CrossValidatedSearch::LeavesMisfit(const FittedSet& one) const {
  const Refit refit = refitter_.FitOrdinary(one.released, {one.point}, kTolerance);
  return refit.usable() && !scale_.At(refit).Resembles(refit.noise);
}

FittedSet CrossValidatedSearch::Polished(const FittedSet& one) const {
  return LeavesOnlyNoise(one) ? one : FitAround(fitter_, options_.seed, one);
}

// Judges the sets that fit nearly as well as the best one, and those that imitate it.
Status CrossValidatedSearch::EndWith(std::vector<FittedSet> made) {
  SINEW_ASSIGN(std::vector<FittedSet> imitating,
               Imitating(*std::min_element(made.begin(), made.end(), FitsBetter)));
  std::move(imitating.begin(), imitating.end(), std::back_inserter(made));
  std::stable_sort(made.begin(), made.end(), FitsBetter);
  const double most = kFarOff * made.front().fitted_error;
  std::size_t near = 1;
  while (near < std::min(made.size(), kMaxLeftOut) && made[near].fitted_error <= most) ++near;
  made.resize(near);
  fitter_.LeaveOut(made);
  judged_.Add(std::move(made));
  return {};
}

// How firm the choice is: sets by the share of resamples of the folds in which they are chosen.
std::vector<double> CrossValidatedSearch::Resample(Outcome& outcome) const {
  std::vector<double> shares = judged_.Shares(options_.seed);
  std::vector<double> of_candidates(candidates_.size(), 0);
  for (std::size_t k = 0; k < judged_.all().size(); ++k) {
    if (shares[k] == 0) continue;
    outcome.resampled.push_back({judged_.all()[k].released, judged_.all()[k].point, shares[k]});
    for (const int c : judged_.all()[k].released) of_candidates[static_cast<std::size_t>(c)] += shares[k];
  }
  for (std::size_t c = 0; c < candidates_.size(); ++c) {
    if (of_candidates[c] > 0) outcome.chosen_shares.emplace_back(static_cast<int>(c), of_candidates[c]);
  }
  return shares;
}

// The sets of the same size with another candidate in place of one cause that fit best, and their errors of
// left-out data. @pre the sets with one cause less are judged
Result<std::vector<FittedSet>> CrossValidatedSearch::Exchanged(const FittedSet& of) const {
  std::vector<FittedSet> sets;
  std::vector<std::vector<Vector>> starts;
  std::vector<FittedSet> smaller;
  std::copy_if(judged_.all().begin(), judged_.all().end(), std::back_inserter(smaller),
               [&](const FittedSet& one) { return IsOneLess(one.released, of.released); });
  SINEW_ASSIGN(const auto scores, fitter_.Score(smaller));
  for (std::size_t i = 0; i < smaller.size(); ++i) {
    if (!scores[i]) continue;
    for (const int c : fitter_.Promising(*scores[i], of.released)) {
      sets.emplace_back(With(smaller[i].released, c));
      starts.push_back(RefitStarts(*scores[i], candidates_, c));
      // Without the cause the others may have moved to where this candidate is of no use.
      fitter_.AddDraws(c, kMoreDraws, smaller[i].point, starts.back());
      fitter_.AddDraws(c, kMoreDraws, of.point, starts.back());
    }
  }
  fitter_.Fit(sets, starts, kRoughTolerance, 1);
  sets = BestFitted(std::move(sets));
  sets.resize(std::min(sets.size(), kMaxLeftOut));
  FitFromEachOther(fitter_, judged_.all(), options_.seed, sets);
  // The fitted error is the smaller one: what is far off there is far off on left-out data, too.
  sets.erase(
      std::remove_if(sets.begin(), sets.end(),
                     [&](const FittedSet& one) { return !(one.fitted_error <= kFarOff * of.fitted_error); }),
      sets.end());
  fitter_.LeaveOut(sets);
  return sets;
}

// Sets of other causes that do to the fitted data what these do together, and that fit nearly as well.
Result<std::vector<FittedSet>> CrossValidatedSearch::Imitating(const FittedSet& of) {
  std::vector<FittedSet> sets;
  SINEW_ASSIGN(const auto wanted, fitter_.ImitatingSets(of));
  std::vector<std::vector<Vector>> starts;
  for (const auto& [released, points] : wanted) {
    if (seen_.count(released) > 0 || !imitating_.insert(released).second) continue;
    sets.emplace_back(released);
    starts.push_back(points);
  }
  fitter_.Fit(sets, starts, kTolerance, kContinued);
  sets.erase(
      std::remove_if(sets.begin(), sets.end(),
                     [&](const FittedSet& one) { return !(one.fitted_error <= kFarOff * of.fitted_error); }),
      sets.end());
  // The others may have ended in a poor minimum; they may still be made by growth.
  for (const FittedSet& one : sets) seen_.insert(one.released);
  return sets;
}

// Sets with another cause each, from more starts than while the sets grow: with the right causes a model that
// lacks one may have taken values from which no search leads on.
Result<std::vector<FittedSet>> CrossValidatedSearch::OneMore(const FittedSet& of) const {
  std::vector<FittedSet> larger;
  if (of.released.size() >= kMostCauses) return larger;
  SINEW_ASSIGN(const auto scored, fitter_.Score(of));
  if (!scored) return larger;
  std::vector<std::vector<Vector>> starts;
  for (const int c : fitter_.Promising(*scored, of.released)) {
    larger.emplace_back(With(of.released, c));
    starts.push_back(RefitStarts(*scored, candidates_, c));
    fitter_.AddDraws(c, kMoreDraws, of.point, starts.back());
  }
  fitter_.Fit(larger, starts, kTolerance, kContinued);
  std::stable_sort(larger.begin(), larger.end(), FitsBetter);
  larger.resize(std::min(larger.size(), kMaxLeftOut));
  fitter_.LeaveOut(larger);
  return larger;
}

// An answer of which a member does nothing on all data is the set without it, although in folds that member
// may act.
void CrossValidatedSearch::Replace(const Set& idle, FittedSet acting) {
  judged_.Bar(idle);
  std::vector<FittedSet> judged{std::move(acting)};
  fitter_.LeaveOut(judged);
  judged_.Add(std::move(judged));
}

// A set is the answer once it, and the sets with one of its causes less, have been fitted from many starts;
// where it leaves more than noise also those with one more and with another one in the place of each.
Result<FittedSet> CrossValidatedSearch::Choose(Shares& shares) {
  std::set<Set> completed;
  std::set<Set> exchanged;
  for (;;) {
    const FittedSet chosen = judged_.Chosen();
    const bool again = completed.count(chosen.released) > 0;
    const bool done = again && (exchanged.count(chosen.released) > 0 || !LeavesMisfit(chosen));
    if (done || completed.size() >= kMaxChoices || fitter_.Interrupted()) {
      if (!again && !fitter_.Interrupted()) {
        const FittedSet acting = fitter_.WithoutIdle(chosen);
        if (acting.released != chosen.released) {
          Replace(chosen.released, acting);
          continue;
        }
      }
      shares.clear();
      for (const FittedSet& less : judged_.all()) {
        if (IsOneLess(less.released, chosen.released))
          shares.emplace_back(MemberBeyond(less.released, chosen.released),
                              chosen.left_out_error / less.left_out_error);
      }
      return chosen;
    }
    if (again) {
      exchanged.insert(chosen.released);
      SINEW_ASSIGN(std::vector<FittedSet> others, Exchanged(chosen));
      // Before they are compared with it, the best are fitted as thoroughly as the chosen set.
      std::stable_sort(others.begin(), others.end(), PredictsBetter);
      for (std::size_t i = 0; i < std::min(others.size(), kPolishedOthers); ++i) {
        if (others[i].left_out_error <= kFarOff * chosen.left_out_error) others[i] = Polished(others[i]);
      }
      judged_.Add(std::move(others));
      SINEW_ASSIGN(std::vector<FittedSet> imitating, Imitating(chosen));
      fitter_.LeaveOut(imitating);
      judged_.Add(std::move(imitating));
      continue;
    }
    completed.insert(chosen.released);
    const FittedSet polished = Polished(chosen);
    const FittedSet acting = fitter_.WithoutIdle(polished);
    if (acting.released != polished.released) {
      Replace(chosen.released, acting);
      continue;
    }
    judged_.Add({polished});
    judged_.Add(fitter_.OneLess(polished, judged_.all()));
    if (!LeavesMisfit(polished)) continue;
    SINEW_ASSIGN(std::vector<FittedSet> larger, OneMore(polished));
    judged_.Add(std::move(larger));
  }
}

Result<std::optional<CrossValidatedSearch::Outcome>> CrossValidatedSearch::Conclude() {
  Outcome outcome;
  outcome.base_error = judged_.all().front().left_out_error;
  SINEW_ASSIGN(const FittedSet best, Choose(outcome.left_out_shares));
  const std::vector<double> shares = Resample(outcome);
  for (const FittedSet& one : judged_.all()) {
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
  outcome.misfit_left = !scale_.At(outcome.model).Resembles(outcome.model.noise);
  if (outcome.misfit_left) {
    outcome.substitutes = FindSubstitutes(judged_.all(), shares, best, refitter_, kFineTolerance);
    SINEW_TRY(AddUnknownTerms(best, outcome));
  }
  return std::optional<Outcome>(std::move(outcome));
}

// Where a term is needed, sets without it are no longer among those that could be chosen, and substitutes are
// judged again beside it.
Status CrossValidatedSearch::AddUnknownTerms(const FittedSet& best, Outcome& outcome) const {
  const auto shrinking = std::make_shared<Refitter>(
      problem_, WithShrunkTerms(refitter_.base(), candidates_, fitter_.Residual(best)), candidates_,
      options_.interrupt);
  const SetFitter fitter(problem_, *shrinking, candidates_, options_, ScoredCandidates::kAll);
  SINEW_ASSIGN(std::optional<BesideUnknown> found, FindUnknownTerms(fitter, candidates_, best, kMostCauses));
  if (!found) return {};
  Refit model = shrinking->FitOrdinary(found->set.released, {found->set.point}, kFineTolerance);
  if (!model.usable()) return {};
  outcome.plain = std::make_shared<Outcome>(outcome);
  outcome.model = std::move(model);
  outcome.released = found->causes;
  outcome.error = found->set.left_out_error;
  outcome.resampled.clear();
  outcome.left_out_shares.clear();
  for (std::size_t i = 0; i < found->causes.size(); ++i)
    outcome.left_out_shares.emplace_back(found->causes[i], found->cause_shares[i]);
  outcome.substitutes = SubstitutesBeside(*found, candidates_, fitter, *shrinking,
                                          std::move(outcome.substitutes), kFineTolerance);
  outcome.beside = std::move(found);
  outcome.refitter = shrinking;
  return {};
}

// Keeps the sets that predict left-out data best, by fits that end early, and the one that fits best.
// @param made by fitted error
void CrossValidatedSearch::Shorten(std::vector<FittedSet>& made) const {
  if (made.size() <= kMaxLeftOut) return;
  made.resize(std::min(made.size(), kMaxRoughlyLeftOut));
  fitter_.LeaveOutRoughly(made);
  std::stable_sort(made.begin() + 1, made.end(), PredictsBetter);
  made.resize(kMaxLeftOut);
}

// Takes causes out of a set as long as the rest predicts clearly better than every set of its size before: a
// cause that was needed while another one was missing (floating search: Pudil, Novovicova, Kittler 1994,
// Pattern Recognit. Lett. 15:1119-1125). Nothing if there is no such set.
std::optional<FittedSet> CrossValidatedSearch::Shrunk(FittedSet from) {
  std::optional<FittedSet> best;
  while (from.released.size() >= kShrunk && !fitter_.Interrupted()) {
    double before = kInfinite;
    double fitted_before = kInfinite;
    for (const FittedSet& one : judged_.all()) {
      if (one.released.size() + 1 != from.released.size()) continue;
      before = std::min(before, one.left_out_error);
      fitted_before = std::min(fitted_before, one.fitted_error);
    }
    const std::vector<FittedSet> smaller = fitter_.OneLess(from, judged_.all(), kFarOff * fitted_before);
    judged_.Add(smaller);
    const auto least = std::min_element(smaller.begin(), smaller.end(), PredictsBetter);
    if (!(least->left_out_error < kShrunkGains * before)) break;
    best = *least;
    from = *least;
  }
  return best;
}

// The next sets, from every one of these; by fitted error.
Result<std::vector<FittedSet>> CrossValidatedSearch::GrownFrom(const std::vector<FittedSet>& beam,
                                                               const ScoredModel& base) {
  std::vector<FittedSet> larger;
  std::copy_if(beam.begin(), beam.end(), std::back_inserter(larger),
               [](const FittedSet& one) { return !one.released.empty(); });
  SINEW_ASSIGN(const auto scores, fitter_.Score(larger));
  std::vector<FittedSet> trials;
  std::vector<std::vector<Vector>> starts;
  auto next_score = scores.begin();
  for (const FittedSet& from : beam) {
    const ScoredModel* scored = &base;
    if (!from.released.empty()) {
      scored = *next_score ? &**next_score : nullptr;
      ++next_score;
    }
    if (scored == nullptr) continue;
    for (const int c : fitter_.Promising(*scored, from.released)) {
      Set next = With(from.released, c);
      if (!seen_.insert(next).second) continue;
      trials.emplace_back(std::move(next));
      starts.push_back(RefitStarts(*scored, candidates_, c));
      // The linear prediction may start in the wrong basin: backlash beside a delay that has taken its place.
      fitter_.AddDraws(c, kGrownDraws, from.point, starts.back());
    }
  }
  fitter_.Fit(trials, starts, kRoughTolerance, 1);
  return BestFitted(std::move(trials));
}

void CrossValidatedSearch::Tell(const FittedSet& best) const {
  if (!options_.progress || fitter_.Interrupted()) return;
  DiagnosisProgress progress{DiagnosisStep::kCrossValidate};
  progress.left_out_share = best.left_out_error / judged_.all().front().left_out_error;
  for (const int c : best.released)
    progress.effects.push_back(candidates_[static_cast<std::size_t>(c)].effect);
  options_.progress(progress);
}

Result<std::optional<CrossValidatedSearch::Outcome>> CrossValidatedSearch::Run(const ScoredModel& base) {
  std::vector<FittedSet> beam(1);
  beam.front().point = base.refit.point;
  fitter_.LeaveOut(beam);
  if (!std::isfinite(beam.front().left_out_error)) return std::optional<Outcome>();
  judged_.Add(beam);
  double least = beam.front().left_out_error;
  std::size_t without_gain = 0;
  for (int growth = 0; growth < kMaxGrowths && without_gain < kIdleGrowths; ++growth) {
    if (beam.front().released.size() >= kMaxSearchedCauses) break;
    SINEW_ASSIGN(std::vector<FittedSet> made, GrownFrom(beam, base));
    if (made.empty()) break;
    if (growth == 0) {
      const Refit one = refitter_.FitOrdinary(made.front().released, {made.front().point}, kTolerance);
      if (one.usable() && scale_.At(one).Resembles(one.noise)) {
        made.resize(1);
        fitter_.LeaveOut(made);
        judged_.Add(made);
        return Conclude();
      }
    }
    // Sets of one cause more cannot leave clearly less, and neither can other starts of these.
    if (LeavesOnlyNoise(made.front())) {
      SINEW_TRY(EndWith(std::move(made)));
      return Conclude();
    }
    Shorten(made);
    FitFromEachOther(fitter_, judged_.all(), options_.seed, made);
    fitter_.FitFromProbes(made);
    SINEW_ASSIGN(std::vector<FittedSet> others,
                 Imitating(*std::min_element(made.begin(), made.end(), FitsBetter)));
    std::move(others.begin(), others.end(), std::back_inserter(made));
    if (LeavesOnlyNoise(*std::min_element(made.begin(), made.end(), FitsBetter))) {
      SINEW_TRY(EndWith(std::move(made)));
      return Conclude();
    }
    fitter_.LeaveOut(made);
    std::stable_sort(made.begin(), made.end(), PredictsBetter);
    judged_.Add(made);
    beam.assign(made.begin(), made.begin() + static_cast<std::ptrdiff_t>(std::min(kBeam, made.size())));
    // One that fits best may need another cause before it predicts well.
    const auto fits_best = std::min_element(made.begin(), made.end(), FitsBetter);
    if (static_cast<std::size_t>(fits_best - made.begin()) >= kBeam) beam.push_back(*fits_best);
    Tell(made.front());
    ++without_gain;
    if (made.front().left_out_error < kStillGains * least) without_gain = 0;
    least = std::min(least, made.front().left_out_error);
    if (std::optional<FittedSet> smaller = Shrunk(made.front())) {
      least = std::min(least, smaller->left_out_error);
      Tell(*smaller);
      beam = {std::move(*smaller)};
      without_gain = 0;
    }
  }
  return Conclude();
}

}  // namespace sinew::diagnosis
