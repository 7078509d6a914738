// The sets of causes whose error of left-out data is known, and the choice among them.
#pragma once

#include <cstdint>
#include <set>
#include <vector>

#include "identify/diagnosis/fit/refit.h"
#include "identify/diagnosis/select/choice_of_sets.h"
#include "identify/diagnosis/select/set_fitter.h"

namespace sinew::diagnosis {

class JudgedSets {
 public:
  /// The arguments must outlive it.
  JudgedSets(const Refitter& refitter, const std::vector<Candidate>& candidates)
      : refitter_(refitter), candidates_(candidates) {}

  /// Those whose error of left-out data is finite; of fits of the same set the one that predicts better
  /// stays.
  void Add(std::vector<FittedSet> made);
  /// Takes a set out, for good.
  void Bar(const std::vector<int>& released);

  /// In the order in which they were added.
  [[nodiscard]] const std::vector<FittedSet>& all() const { return sets_; }
  /// By ChooseSet. @pre not empty
  [[nodiscard]] const FittedSet& Chosen() const;
  /// Of the resamples of the folds, the share in which each set is chosen [all()].
  [[nodiscard]] std::vector<double> Shares(std::uint64_t seed) const;

 private:
  [[nodiscard]] std::vector<JudgedSet> Criteria() const;

  const Refitter& refitter_;
  const std::vector<Candidate>& candidates_;
  std::vector<FittedSet> sets_;
  std::set<std::vector<int>> barred_;
};

}  // namespace sinew::diagnosis
