#include "identify/diagnosis/select/substitutes.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace sinew::diagnosis {
namespace {

constexpr double kNearError = 1.25;      // over that of the answer, of what takes turns with a cause
constexpr double kOftenChosen = 0.1;     // share of the resamples
constexpr double kHardlyTogether = 0.1;  // of the share in which it is chosen alone

bool Contains(const FittedSet& set, int c) {
  return std::binary_search(set.released.begin(), set.released.end(), c);
}

}  // namespace

bool TakesTurns(int candidate, int cause, const std::vector<FittedSet>& judged,
                const std::vector<double>& shares) {
  double alone = 0;
  double together = 0;
  for (std::size_t k = 0; k < judged.size(); ++k) {
    if (Contains(judged[k], candidate)) (Contains(judged[k], cause) ? together : alone) += shares[k];
  }
  return alone >= kOftenChosen && together < kHardlyTogether * alone;
}

std::vector<Substitute> FindSubstitutes(const std::vector<FittedSet>& judged,
                                        const std::vector<double>& shares, const FittedSet& answer,
                                        const Refitter& refitter, double tolerance) {
  std::vector<Substitute> found;
  for (const FittedSet& one : judged) {
    const double share = one.left_out_error / answer.left_out_error;
    if (one.released.size() != answer.released.size() || !(share <= kNearError)) continue;
    std::vector<int> gone;
    std::vector<int> come;
    std::set_difference(answer.released.begin(), answer.released.end(), one.released.begin(),
                        one.released.end(), std::back_inserter(gone));
    std::set_difference(one.released.begin(), one.released.end(), answer.released.begin(),
                        answer.released.end(), std::back_inserter(come));
    if (gone.size() != 1) continue;
    if (share > kSameError && !TakesTurns(come.front(), gone.front(), judged, shares)) continue;
    Refit refit = refitter.FitOrdinary(one.released, {one.point}, tolerance);
    if (refit.usable()) found.push_back({gone.front(), come.front(), share, std::move(refit)});
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const Substitute& a, const Substitute& b) { return a.error < b.error; });
  return found;
}

std::vector<Substitute> SubstitutesBeside(const BesideUnknown& terms,
                                          const std::vector<Candidate>& candidates, const SetFitter& fitter,
                                          const Refitter& refitter, std::vector<Substitute> before,
                                          double tolerance) {
  const auto is_cause = [&](int c) {
    return std::find(terms.causes.begin(), terms.causes.end(), c) != terms.causes.end();
  };
  before.erase(std::remove_if(before.begin(), before.end(),
                              [&](const Substitute& other) {
                                return !is_cause(other.cause) || is_cause(other.candidate);
                              }),
               before.end());
  std::vector<FittedSet> sets;
  std::vector<std::vector<Vector>> starts;
  for (const Substitute& other : before) {
    Vector start = terms.set.point;
    for (const int c : {other.cause, other.candidate}) {
      for (const int index : candidates[static_cast<std::size_t>(c)].parameters)
        start[index] = other.refit.point[index];
    }
    sets.emplace_back(With(Without(terms.set.released, other.cause), other.candidate));
    starts.push_back({std::move(start)});
  }
  fitter.Fit(sets, starts, SetFitter::kTolerance, SetFitter::kContinued);
  fitter.LeaveOut(sets);
  std::vector<Substitute> found;
  for (std::size_t i = 0; i < sets.size(); ++i) {
    const double share = sets[i].left_out_error / terms.set.left_out_error;
    if (!(share <= (before[i].error <= kSameError ? kSameError : kNearError))) continue;
    Refit refit = refitter.FitOrdinary(sets[i].released, {sets[i].point}, tolerance);
    if (refit.usable()) found.push_back({before[i].cause, before[i].candidate, share, std::move(refit)});
  }
  return found;
}

}  // namespace sinew::diagnosis
