// The models that a selection by likelihood compares, each fitted once.
#pragma once

#include <map>
#include <vector>

#include "identify/diagnosis/diagnosis.h"
#include "identify/diagnosis/fit/refit.h"

namespace sinew::diagnosis {

/// Deviance of a refit less that of another one. Where a search found the causes, a smaller set leaves a
/// misfit that its noise model may absorb: both then count as having independent errors, unless both leave no
/// more than noise of the inputs.
[[nodiscard]] double DevianceDifference(bool found_by_search, const Refit& refit, const Refit& reference);

class RefitCache {
 public:
  using Set = std::vector<int>;

  /// With the base model. The arguments must outlive it.
  RefitCache(const Refitter& refitter, const std::vector<Candidate>& candidates, const Refit& base,
             const DiagnosisOptions& options);

  /// Refits the sets that are not known yet, in parallel. A model cannot fit worse than one that it contains:
  /// where its refit does, the start moved the effect alone and lost the trajectory; it starts again from
  /// that model, so that all values move together. @param wanted sets and the starts [P] of each, not empty
  void Fit(const std::map<Set, std::vector<Vector>>& wanted);

  /// Refits the sets with one member less, from where the others take over what they can (StartsWithout) and
  /// from the member's null. One that is known is refitted if it fits worse than at the first of these: it
  /// has missed its minimum. @param released more than one, fitted and usable @return the smaller sets
  std::vector<Set> FitWithoutEach(const Set& released);

  /// @pre it was fitted
  [[nodiscard]] const Refit& at(const Set& released) const { return refits_.at(released); }
  /// nullptr if it was not fitted, or failed.
  [[nodiscard]] const Refit* FindUsable(const Set& released) const;
  [[nodiscard]] const std::map<Set, Refit>& all() const { return refits_; }

  /// From now on deviances are compared as after a search (DevianceDifference).
  void CompareAsAfterSearch() { found_by_search_ = true; }
  /// From now on refits that stop early are continued.
  void ContinueRefits() { continued_ = true; }

  [[nodiscard]] double Difference(const Refit& refit, const Refit& reference) const {
    return DevianceDifference(found_by_search_, refit, reference);
  }

 private:
  // Starts of the sets with one member less, the better one first.
  [[nodiscard]] std::map<Set, std::vector<Vector>> StartsOfParts(const Set& released) const;
  [[nodiscard]] bool FitsWorseThan(const Vector& point, const Refit& refit) const;
  void Improve(const Set& released, const Vector& start, Refit& refit) const;
  void Replace(Refit by, Refit& refit) const;

  const Refitter& refitter_;
  const std::vector<Candidate>& candidates_;
  const DiagnosisOptions& options_;
  std::map<Set, Refit> refits_;
  bool found_by_search_ = false;
  bool continued_ = false;
};

}  // namespace sinew::diagnosis
