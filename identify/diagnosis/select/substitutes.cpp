#include "identify/diagnosis/select/substitutes.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace sinew::diagnosis {
namespace {

constexpr double kSubstitute = 1.05;  // error of a substitute over that of the answer, at most

}  // namespace

std::vector<Substitute> FindSubstitutes(const std::vector<FittedSet>& judged, const FittedSet& answer,
                                        const Refitter& refitter, double tolerance) {
  std::vector<Substitute> found;
  for (const FittedSet& one : judged) {
    const double share = one.left_out_error / answer.left_out_error;
    if (one.released.size() != answer.released.size() || !(share <= kSubstitute)) continue;
    std::vector<int> gone;
    std::vector<int> come;
    std::set_difference(answer.released.begin(), answer.released.end(), one.released.begin(),
                        one.released.end(), std::back_inserter(gone));
    std::set_difference(one.released.begin(), one.released.end(), answer.released.begin(),
                        answer.released.end(), std::back_inserter(come));
    if (gone.size() != 1) continue;
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
    sets.push_back({With(Without(terms.set.released, other.cause), other.candidate), {}, 0, 0, {}});
    starts.push_back({std::move(start)});
  }
  fitter.Fit(sets, starts, SetFitter::kTolerance, SetFitter::kContinued);
  fitter.LeaveOut(sets, SetFitter::kTolerance);
  std::vector<Substitute> found;
  for (std::size_t i = 0; i < sets.size(); ++i) {
    const double share = sets[i].left_out_error / terms.set.left_out_error;
    if (!(share <= kSubstitute)) continue;
    Refit refit = refitter.FitOrdinary(sets[i].released, {sets[i].point}, tolerance);
    if (refit.usable()) found.push_back({before[i].cause, before[i].candidate, share, std::move(refit)});
  }
  return found;
}

}  // namespace sinew::diagnosis
