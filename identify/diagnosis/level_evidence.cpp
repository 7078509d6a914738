#include "identify/diagnosis/level_evidence.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "base/constants.h"
#include "identify/diagnosis/score/shortlist.h"
#include "identify/execution/executor.h"

namespace sinew::diagnosis {
namespace {

constexpr std::size_t kMostEffects = 3;  // of one level

class LevelWeighing {
 public:
  using Set = std::vector<int>;

  explicit LevelWeighing(const DiagnosisState& state) : state_(state) {
    const Shortlist shortlist(state.candidates, state.base);
    for (const int c : shortlist.All()) of_level_[state.candidate(c).level].push_back(c);
  }

  /// By likelihood.
  [[nodiscard]] std::vector<LevelEvidence> Refitted() const {
    std::vector<Set> wanted;
    for (const auto& [level, candidates] : of_level_) {
      for (Set& set : SetsOf(candidates)) wanted.push_back(std::move(set));
    }
    std::vector<Vector> starts;
    for (const Set& set : wanted) starts.push_back(StartOf(set));
    for (const auto& [level, candidates] : of_level_) {
      if (auto exchanged = WithAlternativesOf(level)) {
        wanted.push_back(std::move(exchanged->first));
        starts.push_back(std::move(exchanged->second));
      }
    }
    std::vector<Refit> made(wanted.size());
    MakeExecutor(state_.options.threads)->ForEach(wanted.size(), [&](std::size_t i, std::size_t) {
      made[i] = Known(wanted[i]);
      if (made[i].released.empty()) made[i] = state_.Fit(wanted[i], {starts[i]});
    });
    for (const Refit& tried : state_.selection.tried) made.push_back(tried);
    if (!state_.selection.model.released.empty()) made.push_back(state_.selection.model);

    std::vector<LevelEvidence> levels;
    for (const auto& [level, candidates] : of_level_) {
      LevelEvidence one;
      one.level = level;
      const Refit* best = nullptr;
      for (const Refit& refit : made) {
        if (refit.usable() && IsOf(level, refit.released) && (best == nullptr || Penalised(refit, *best) < 0))
          best = &refit;
      }
      if (best != nullptr) {
        one.delta_lr = -state_.Difference(*best, state_.base.refit);
        one.parameters = Parameters(best->released);
        one.behind = Penalised(*best, state_.selection.model);
        for (const int c : best->released) one.effects.push_back(state_.candidate(c).effect);
      } else {
        one.behind = Penalised(state_.base.refit, state_.selection.model);
      }
      levels.push_back(std::move(one));
    }
    return levels;
  }

  /// By cross-validation.
  [[nodiscard]] std::vector<LevelEvidence> LeftOut() const {
    std::vector<LevelEvidence> levels;
    for (const auto& [level, candidates] : of_level_) {
      LevelEvidence one;
      one.level = level;
      one.delta_lr = one.behind = kNaN;
      const JudgedShare* best = nullptr;
      for (const JudgedShare& set : state_.selection.judged) {
        if (IsOf(level, set.released) && (best == nullptr || set.share < best->share)) best = &set;
      }
      if (best != nullptr) {
        one.left_out = best->share;
        one.parameters = Parameters(best->released);
        for (const int c : best->released) one.effects.push_back(state_.candidate(c).effect);
      }
      levels.push_back(std::move(one));
    }
    return levels;
  }

 private:
  [[nodiscard]] bool IsOf(Level level, const Set& released) const {
    return !released.empty() && std::all_of(released.begin(), released.end(),
                                            [&](int c) { return state_.candidate(c).level == level; });
  }

  [[nodiscard]] int Parameters(const Set& released) const {
    int count = 0;
    for (const int c : released) count += static_cast<int>(state_.candidate(c).parameters.size());
    return count;
  }
  // Deviance of a refit less that of another one, with their prices.
  [[nodiscard]] double Penalised(const Refit& refit, const Refit& reference) const {
    return state_.Difference(refit, reference) +
           kPerParameter * (Parameters(refit.released) - Parameters(reference.released));
  }

  // The refit of one effect that the selection has made; nothing released if it has not.
  [[nodiscard]] Refit Known(const Set& released) const {
    for (const Refit& tried : state_.selection.tried) {
      if (tried.released == released) return tried;
    }
    return {};
  }

  // The causes, those of other levels replaced by their best alternatives of this one, and where to fit them
  // from. Nothing if there is nothing to replace, or a cause has no such alternative.
  [[nodiscard]] std::optional<std::pair<Set, Vector>> WithAlternativesOf(Level level) const {
    Set set;
    Vector start = state_.selection.model.point;
    for (const ChosenCause& cause : state_.selection.causes) {
      if (state_.candidate(cause.candidate).level == level) {
        set.push_back(cause.candidate);
        continue;
      }
      const Rival* best = nullptr;
      for (const Rival& rival : state_.selection.rivals) {
        if (rival.instead_of != cause.candidate || state_.candidate(rival.candidate).level != level) continue;
        if (best == nullptr || rival.delta_lr < best->delta_lr) best = &rival;
      }
      if (best == nullptr) return {};
      for (const int index : state_.candidate(cause.candidate).parameters)
        start[index] = state_.base.refit.point[index];
      for (const int index : state_.candidate(best->candidate).parameters)
        start[index] = best->refit.point[index];
      set.push_back(best->candidate);
    }
    std::sort(set.begin(), set.end());
    const bool repeated = std::adjacent_find(set.begin(), set.end()) != set.end();
    if (repeated || set.empty() || set == state_.selection.model.released) return {};
    return std::pair(std::move(set), std::move(start));
  }

  // The effect with the largest score at its price, and the best set that grows from it.
  [[nodiscard]] std::vector<Set> SetsOf(const std::vector<int>& candidates) const {
    std::vector<Set> sets;
    std::vector<const Score*> chosen;
    Set set;
    double explained = 0;
    const std::size_t most = std::min(kMostEffects, state_.selection.model.released.size() + 1);
    while (set.size() < most) {
      const Score* best = nullptr;
      double most_explained = explained;
      for (const int c : candidates) {
        if (std::find(set.begin(), set.end(), c) != set.end()) continue;
        const Score* score = state_.base.BestOf(c);
        if (score == nullptr) continue;
        std::vector<const Score*> together = chosen;
        together.push_back(score);
        Set larger = set;
        larger.push_back(c);
        const double value =
            JointStatistic(state_.base.whitened, together) - kPerParameter * Parameters(larger);
        // Even where no effect is worth its price, the best one stands for its level.
        if (value > most_explained || (set.empty() && (best == nullptr || value > most_explained))) {
          most_explained = value;
          best = score;
        }
      }
      if (best == nullptr) break;
      explained = most_explained;
      chosen.push_back(best);
      set.push_back(best->candidate);
      Set sorted = set;
      std::sort(sorted.begin(), sorted.end());
      sets.push_back(std::move(sorted));
    }
    return sets;
  }

  [[nodiscard]] Vector StartOf(const Set& released) const {
    Vector start = RefitStarts(state_.base, state_.candidates, released.front()).front();
    for (std::size_t i = 1; i < released.size(); ++i) {
      const Vector other = RefitStarts(state_.base, state_.candidates, released[i]).front();
      for (const int index : state_.candidate(released[i]).parameters) start[index] = other[index];
    }
    return start;
  }

  const DiagnosisState& state_;
  std::map<Level, std::vector<int>> of_level_;
};

bool Blames(const Diagnosis& diagnosis, Level level) {
  return std::any_of(diagnosis.causes.begin(), diagnosis.causes.end(),
                     [&](const Cause& cause) { return cause.level == level; });
}

bool MayReplaceACause(const Diagnosis& diagnosis, Level level) {
  return std::any_of(diagnosis.alternatives.begin(), diagnosis.alternatives.end(),
                     [&](const Alternative& other) { return other.level == level && !other.contains_cause; });
}

}  // namespace

void WeighLevels(const DiagnosisState& state, Diagnosis& diagnosis) {
  if (!state.selection.alarm) return;
  const LevelWeighing weighing(state);
  diagnosis.levels = state.selection.cross_validated ? weighing.LeftOut() : weighing.Refitted();
  for (LevelEvidence& one : diagnosis.levels) {
    one.suffices = one.behind <= SetWidth(state.selection.model);
    if (Blames(diagnosis, one.level)) {
      one.standing = LevelStanding::kBlamed;
    } else if (!diagnosis.causes.empty() && (MayReplaceACause(diagnosis, one.level) || one.suffices)) {
      one.standing = LevelStanding::kPossible;
    }
  }
  std::stable_sort(diagnosis.levels.begin(), diagnosis.levels.end(),
                   [](const LevelEvidence& a, const LevelEvidence& b) {
                     if (a.standing != b.standing) return a.standing < b.standing;
                     return std::isfinite(a.behind) && std::isfinite(b.behind) && a.behind < b.behind;
                   });
}

}  // namespace sinew::diagnosis
