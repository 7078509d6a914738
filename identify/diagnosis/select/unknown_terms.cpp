#include "identify/diagnosis/select/unknown_terms.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "identify/diagnosis/select/choice_of_sets.h"

namespace sinew::diagnosis {
namespace {

constexpr std::size_t kMaxTerms = 2;
constexpr double kOfRange = 1.0 / 3;
constexpr double kOfResidual = 0.01;
constexpr std::size_t kMaxFurtherLeftOut = 3;

class Search {
 public:
  Search(const SetFitter& fitter, const std::vector<Candidate>& candidates, const FittedSet& answer,
         std::size_t most)
      : fitter_(fitter), candidates_(candidates), answer_(answer), most_(most), now_(answer) {}

  Result<std::optional<BesideUnknown>> Run() {
    while (terms_.size() < kMaxTerms && !fitter_.Interrupted()) {
      SINEW_ASSIGN(const bool added, AddTerm());
      if (!added) break;
      SINEW_TRY(ChooseCauses());
    }
    if (terms_.empty()) return std::optional<BesideUnknown>();
    BesideUnknown out;
    for (const FittedSet& less : fitter_.OneLessByContinuation(now_)) {
      const int c = MemberBeyond(less.released, now_.released);
      if (!IsKnown(c)) continue;
      out.causes.push_back(c);
      out.cause_shares.push_back(now_.left_out_error / less.left_out_error);
    }
    for (const int c : answer_.released) {
      if (!Has(now_, c)) out.imitations.push_back(c);
    }
    out.terms = terms_;
    out.set = std::move(now_);
    return std::optional<BesideUnknown>(std::move(out));
  }

 private:
  [[nodiscard]] bool IsKnown(int c) const { return candidates_[static_cast<std::size_t>(c)].known; }

  static bool Has(const FittedSet& set, int c) {
    return std::binary_search(set.released.begin(), set.released.end(), c);
  }

  // The sets with one of the candidates each, fitted and left out; best first.
  [[nodiscard]] std::vector<FittedSet> Extended(const FittedSet& from, const ScoredModel& scored,
                                                const std::vector<int>& by, std::size_t left_out) const {
    std::vector<FittedSet> sets;
    std::vector<std::vector<Vector>> starts;
    for (const int c : by) {
      sets.emplace_back(With(from.released, c));
      starts.push_back(RefitStarts(scored, candidates_, c));
      starts.back().push_back(from.point);
    }
    fitter_.Fit(sets, starts, SetFitter::kTolerance, SetFitter::kContinued);
    std::stable_sort(sets.begin(), sets.end(), FitsBetter);
    sets.resize(std::min(sets.size(), left_out));
    fitter_.LeaveOut(sets);
    std::stable_sort(sets.begin(), sets.end(), PredictsBetter);
    return sets;
  }

  Result<bool> AddTerm() {
    SINEW_ASSIGN(const auto scored, fitter_.Score(now_));
    if (!scored) return false;
    const std::vector<int> terms = fitter_.PromisingTerms(*scored, now_.released);
    if (terms.empty()) return false;
    const std::vector<FittedSet> more = Extended(now_, *scored, terms, terms.size());
    if (!IsNeeded(more.front().fold_errors, now_.fold_errors)) return false;
    terms_.push_back(MemberBeyond(now_.released, more.front().released));
    now_ = more.front();
    return true;
  }

  Status ChooseCauses() {
    TakeOutCauses();
    SINEW_TRY(AddCauses());
    TakeOutCauses();
    return {};
  }

  // Takes out the least needed cause as long as it is not needed.
  void TakeOutCauses() {
    for (;;) {
      std::vector<FittedSet> smaller = fitter_.OneLessByContinuation(now_);
      const FittedSet* least = nullptr;
      for (const FittedSet& less : smaller) {
        if (!IsKnown(MemberBeyond(less.released, now_.released)) || less.fold_errors.empty()) continue;
        if (least == nullptr || PredictsBetter(less, *least)) least = &less;
      }
      if (least == nullptr || IsNeeded(now_.fold_errors, least->fold_errors)) return;
      now_ = *least;
    }
  }

  // Known effects that are needed beside the terms.
  Status AddCauses() {
    while (now_.released.size() < most_ + terms_.size() && !fitter_.Interrupted()) {
      SINEW_ASSIGN(const auto scored, fitter_.Score(now_));
      if (!scored) return {};
      const std::vector<int> known = fitter_.Promising(*scored, now_.released);
      if (known.empty()) return {};
      const std::vector<FittedSet> more = Extended(now_, *scored, known, kMaxFurtherLeftOut);
      if (!IsNeeded(more.front().fold_errors, now_.fold_errors)) return {};
      now_ = more.front();
    }
    return {};
  }

  const SetFitter& fitter_;
  const std::vector<Candidate>& candidates_;
  const FittedSet& answer_;
  std::size_t most_;
  FittedSet now_;
  std::vector<int> terms_;  // of now_, in the order in which they were added
};

}  // namespace

FitSetup WithShrunkTerms(FitSetup setup, const std::vector<Candidate>& candidates, double residual) {
  for (const Candidate& candidate : candidates) {
    if (candidate.known) continue;
    const double share = kOfRange * std::sqrt(static_cast<double>(candidate.parameters.size()));
    for (const int index : candidate.parameters) {
      Parameter& weight = setup.parameters[static_cast<std::size_t>(index)];
      weight.prior = GaussianPrior{weight.null_value, share * weight.upper / (kOfResidual * residual)};
    }
  }
  return setup;
}

Result<std::optional<BesideUnknown>> FindUnknownTerms(const SetFitter& fitter,
                                                      const std::vector<Candidate>& candidates,
                                                      const FittedSet& answer, std::size_t most) {
  return Search(fitter, candidates, answer, most).Run();
}

}  // namespace sinew::diagnosis
