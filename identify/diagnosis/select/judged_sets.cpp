#include "identify/diagnosis/select/judged_sets.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace sinew::diagnosis {

void JudgedSets::Add(std::vector<FittedSet> made) {
  for (FittedSet& one : made) {
    if (!std::isfinite(one.left_out_error)) continue;
    if (barred_.count(one.released) > 0) continue;
    const auto known = std::find_if(sets_.begin(), sets_.end(),
                                    [&](const FittedSet& other) { return other.released == one.released; });
    if (known == sets_.end()) {
      sets_.push_back(std::move(one));
    } else if (PredictsBetter(one, *known)) {
      *known = std::move(one);
    }
  }
}

void JudgedSets::Bar(const std::vector<int>& released) {
  barred_.insert(released);
  sets_.erase(std::remove_if(sets_.begin(), sets_.end(),
                             [&](const FittedSet& one) { return one.released == released; }),
              sets_.end());
}

const FittedSet& JudgedSets::Chosen() const {
  return sets_[ChooseSet(Criteria())];
}

std::vector<double> JudgedSets::Shares(std::uint64_t seed) const {
  return ChosenShares(Criteria(), seed);
}

std::vector<JudgedSet> JudgedSets::Criteria() const {
  std::vector<JudgedSet> criteria;
  for (const FittedSet& one : sets_) {
    JudgedSet set{one.released, one.fold_errors};
    for (const int index : refitter_.base().free) {
      const Parameter& p = refitter_.base().parameters[static_cast<std::size_t>(index)];
      const double value = one.point[index];
      if (p.kind == ParameterKind::kBase && (value <= p.lower || value >= p.upper)) ++set.at_bound;
    }
    for (const int c : one.released)
      set.rarity += static_cast<int>(candidates_[static_cast<std::size_t>(c)].occurrence);
    criteria.push_back(std::move(set));
  }
  return criteria;
}

}  // namespace sinew::diagnosis
