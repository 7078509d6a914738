#include "identify/diagnosis/score/shortlist.h"

#include <algorithm>
#include <map>
#include <set>

namespace sinew::diagnosis {
namespace {

constexpr std::size_t kMinSurvivors = 4;
constexpr std::size_t kMaxSurvivors = 14;
constexpr std::size_t kMaxPairs = 8;
constexpr double kOutlyingRatio = 3;       // least ratio to the score of any other trial fitted beside it ...
constexpr double kOutlyingDifference = 6;  // ... and least difference

}  // namespace

Shortlist::Shortlist(const std::vector<Candidate>& candidates, const ScoredModel& base)
    : candidates_(candidates), base_(base) {
  FindOutlyingTrial();
}

// Among the effects of one kind that every trial has, one trial is outlying if its score stays far above
// those of the others once it is released. (The base model compensates a fault of one trial by half, so that
// before the release all other trials show the opposite fault.)
void Shortlist::FindOutlyingTrial() {
  std::map<std::string, std::vector<const Score*>> of_kind;  // effect without its trial
  for (std::size_t c = 0; c < candidates_.size(); ++c) {
    const Candidate& candidate = candidates_[c];
    const Score* score = base_.BestOf(static_cast<int>(c));
    if (!candidate.known || candidate.trial.empty() || score == nullptr) continue;
    const std::string kind = candidate.effect.substr(0, candidate.effect.rfind('@'));
    of_kind[kind].push_back(score);
  }
  double most = 0;
  for (const auto& [kind, answers] : of_kind) {
    const Score* first =
        *std::max_element(answers.begin(), answers.end(),
                          [](const Score* a, const Score* b) { return a->statistic < b->statistic; });
    const double price = kPerParameter * static_cast<double>(first->directions.size());
    double others = 0;
    for (const Score* other : answers) {
      if (other == first) continue;
      const double beside = JointStatistic(base_.whitened, {first, other}) - first->statistic;
      others = std::max(others, beside - kPerParameter * static_cast<double>(other->directions.size()));
    }
    if (first->statistic - price < kOutlyingRatio * others + kOutlyingDifference || first->statistic <= most)
      continue;
    most = first->statistic;
    outlying_trial_ = candidates_[static_cast<std::size_t>(first->candidate)].trial;
  }
}

bool Shortlist::MayBeNamed(int c) const {
  const std::string& trial = candidates_[static_cast<std::size_t>(c)].trial;
  return trial.empty() || trial == outlying_trial_;
}

std::vector<int> Shortlist::Singles(const ScoredModel& scored) const {
  std::set<int> survivors;
  for (const ScoreTable* table : {&scored.whitened, &scored.plain}) {
    std::vector<std::pair<double, int>> ranking;
    for (std::size_t c = 0; c < candidates_.size(); ++c) {
      if (!candidates_[c].known || !MayBeNamed(static_cast<int>(c))) continue;
      const Score* score = scored.BestOf(static_cast<int>(c), *table);
      if (score == nullptr) continue;
      const double price = kPerParameter * static_cast<double>(score->directions.size() - 1);
      ranking.emplace_back(score->statistic - price - (candidates_[c].primary() ? 0 : 2 * kPerParameter),
                           static_cast<int>(c));
    }
    std::sort(ranking.begin(), ranking.end(), [](const auto& a, const auto& b) {
      return a.first != b.first ? a.first > b.first : a.second < b.second;
    });
    for (std::size_t i = 0; i < std::min(ranking.size(), kMaxSurvivors); ++i) {
      const double behind = ranking.front().first - ranking[i].first;
      if (i >= kMinSurvivors && behind > std::max(2 * kSetWidth, 0.4 * ranking.front().first)) break;
      if (ranking[i].first > 0) survivors.insert(ranking[i].second);
    }
    if (table == &scored.whitened && !scored.refit.noise.IsColoured()) break;
  }
  return {survivors.begin(), survivors.end()};
}

std::vector<int> Shortlist::All() const {
  std::vector<int> all;
  for (std::size_t c = 0; c < candidates_.size(); ++c) {
    if (candidates_[c].known && candidates_[c].drifting < 0 && !candidates_[c].parameters.empty() &&
        MayBeNamed(static_cast<int>(c)))
      all.push_back(static_cast<int>(c));
  }
  return all;
}

std::vector<std::pair<int, int>> Shortlist::Pairs() const {
  std::map<std::pair<int, int>, double> best_of;
  const auto& scores = base_.whitened.scores;
  for (std::size_t i = 0; i < scores.size(); ++i) {
    for (std::size_t j = i + 1; j < scores.size(); ++j) {
      const Score& a = scores[i];
      const Score& b = scores[j];
      const Candidate& first = candidates_[static_cast<std::size_t>(a.candidate)];
      const Candidate& second = candidates_[static_cast<std::size_t>(b.candidate)];
      if (!first.primary() || !second.primary() || a.candidate == b.candidate) continue;
      const double statistic =
          JointStatistic(base_.whitened, {&a, &b}) -
          kPerParameter * static_cast<double>(first.parameters.size() + second.parameters.size());
      const auto [at, is_new] = best_of.emplace(std::pair(a.candidate, b.candidate), statistic);
      if (!is_new) at->second = std::max(at->second, statistic);
    }
  }
  std::vector<std::pair<double, std::pair<int, int>>> pairs;
  for (const auto& [pair, statistic] : best_of) pairs.emplace_back(statistic, pair);
  std::stable_sort(pairs.begin(), pairs.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  if (pairs.size() > kMaxPairs) pairs.resize(kMaxPairs);
  std::vector<std::pair<int, int>> best;
  for (const auto& [statistic, pair] : pairs) best.push_back(pair);
  return best;
}

}  // namespace sinew::diagnosis
