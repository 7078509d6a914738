#include "identify/diagnosis/select/refit_cache.h"

#include <utility>

#include "identify/diagnosis/select/candidate_sets.h"
#include "identify/diagnosis/select/starts_without.h"
#include "identify/execution/shared_loop.h"

namespace sinew::diagnosis {
namespace {

// Times that a refit is continued where scores are contradicted, while its deviance falls by more than this.
constexpr int kContinuations = 3;
constexpr double kWorthContinuing = 0.1;
// A refit that ends this much above the model that it contains [deviance] has missed its minimum.
constexpr double kAboveItsPart = 1e-3;

}  // namespace

double DevianceDifference(bool found_by_search, const Refit& refit, const Refit& reference) {
  if (found_by_search && !(refit.holds_input_noise && reference.holds_input_noise))
    return IndependentDifference(refit, reference);
  return LikelihoodDifference(refit, reference);
}

RefitCache::RefitCache(const Refitter& refitter, const std::vector<Candidate>& candidates, const Refit& base,
                       const DiagnosisOptions& options)
    : refitter_(refitter), candidates_(candidates), options_(options), refits_{{{}, base}} {}

void RefitCache::Fit(const std::map<Set, std::vector<Vector>>& wanted) {
  std::vector<std::pair<Set, std::vector<Vector>>> work;
  for (const auto& [released, starts] : wanted) {
    if (refits_.count(released) == 0) work.emplace_back(released, starts);
  }
  std::vector<Refit> made(work.size());
  ForEachShared(options_.record, options_.threads, work.size(),
                [&](std::size_t i, std::size_t) { made[i] = refitter_.Fit(work[i].first, work[i].second); });
  ForEachShared(options_.record, options_.threads, work.size(),
                [&](std::size_t i, std::size_t) { Improve(work[i].first, work[i].second.front(), made[i]); });
  for (std::size_t i = 0; i < work.size(); ++i) refits_[work[i].first] = std::move(made[i]);
}

std::map<RefitCache::Set, std::vector<Vector>> RefitCache::StartsOfParts(const Set& released) const {
  const Refit& model = at(released);
  const Vector& nulls = at({}).point;
  std::vector<std::vector<int>> causes;
  for (const int c : released) causes.push_back(candidates_[static_cast<std::size_t>(c)].parameters);
  LeastSquares fit(refitter_.problem(), *model.setup);
  const noise::Whitening whitening(model.noise, TrainStretches(fit));
  fit.set_transform(&whitening);
  const auto taken_over = StartsWithout(fit, model.x, causes, nulls);
  std::map<Set, std::vector<Vector>> starts;
  for (std::size_t i = 0; i < released.size(); ++i) {
    std::vector<Vector>& own = starts[Without(released, released[i])];
    if (taken_over) own.push_back((*taken_over)[i]);
    Vector at_null = model.point;
    for (const int index : causes[i]) at_null[index] = nulls[index];
    own.push_back(std::move(at_null));
  }
  return starts;
}

bool RefitCache::FitsWorseThan(const Vector& point, const Refit& refit) const {
  if (!refit.usable()) return true;
  const LeastSquares fit(refitter_.problem(), *refit.setup);
  auto workspace = fit.NewWorkspace();
  const auto there = fit.Cost(fit.Variables(point), workspace);
  const auto now = fit.Cost(refit.x, workspace);
  return there && now && *there < *now;
}

std::vector<RefitCache::Set> RefitCache::FitWithoutEach(const Set& released) {
  const auto wanted = StartsOfParts(released);
  std::vector<Set> sets;
  std::vector<Set> missed;
  for (const auto& [set, starts] : wanted) {
    sets.push_back(set);
    if (refits_.count(set) > 0 && FitsWorseThan(starts.front(), at(set))) missed.push_back(set);
  }
  Fit(wanted);
  std::vector<Refit> again(missed.size());
  ForEachShared(options_.record, options_.threads, missed.size(), [&](std::size_t i, std::size_t) {
    again[i] = refitter_.Fit(missed[i], wanted.at(missed[i]));
  });
  for (std::size_t i = 0; i < missed.size(); ++i) Replace(std::move(again[i]), refits_[missed[i]]);
  return sets;
}

const Refit* RefitCache::FindUsable(const Set& released) const {
  const auto found = refits_.find(released);
  return found != refits_.end() && found->second.usable() ? &found->second : nullptr;
}

void RefitCache::Improve(const Set& released, const Vector& start, Refit& refit) const {
  const FitSetup& base = refitter_.base();
  for (const int c : released) {
    const Refit* part = FindUsable(Without(released, c));
    if (part == nullptr || (refit.usable() && Difference(refit, *part) <= kAboveItsPart)) continue;
    const Candidate& candidate = candidates_[static_cast<std::size_t>(c)];
    Vector from = part->point;
    for (const auto& [index, value] : candidate.probes.front().at) from[index] = start[index];
    for (const int index : ScoredParameters(candidate, 0))
      from[index] = base.parameters[static_cast<std::size_t>(index)].null_value;
    Replace(refitter_.Fit(released, {from}), refit);
  }
  for (int k = 0; continued_ && k < kContinuations && refit.usable() && !refit.converged; ++k) {
    const double before = refit.deviance;
    Replace(refitter_.Fit(released, {Vector(refit.point)}), refit);
    if (refit.deviance > before - kWorthContinuing) break;
  }
}

void RefitCache::Replace(Refit by, Refit& refit) const {
  if (by.usable() && (!refit.usable() || Difference(by, refit) < 0)) refit = std::move(by);
}

}  // namespace sinew::diagnosis
