#include "identify/diagnosis/select/further_fits.h"

#include <algorithm>
#include <utility>

#include "base/random.h"
#include "identify/diagnosis/select/many_starts.h"

namespace sinew::diagnosis {
namespace {

constexpr std::size_t kDrawnSets = 3;  // of one size, those that fit best
constexpr std::size_t kGroups = 4;     // of starts around a set, each by one thread
constexpr int kMaxRounds = 8;          // of starts around the best solution so far ...
constexpr int kIdleRounds = 2;         // ... until so many have found none ...
constexpr double kLower = 0.999;       // ... with a fitted error below this share

}  // namespace

void FitFromEachOther(const SetFitter& fitter, const std::vector<FittedSet>& judged, std::uint64_t seed,
                      std::vector<FittedSet>& sets) {
  std::vector<FittedSet> again = sets;
  std::vector<std::vector<Vector>> starts(sets.size());
  for (std::size_t i = 0; i < sets.size(); ++i) {
    const FitSetup setup = fitter.SetupWith(sets[i].released);
    for (std::size_t other = 0; other < sets.size(); ++other) {
      if (other == i) continue;
      const FitSetup theirs = fitter.SetupWith(sets[other].released);
      Vector start = sets[i].point;
      for (const int index : setup.free) {
        if (theirs.IsFree(index)) start[index] = sets[other].point[index];
      }
      starts[i].push_back(std::move(start));
    }
    for (const FittedSet& smaller : judged) {
      if (!IsOneLess(smaller.released, sets[i].released)) continue;
      // The parameters of the further cause as they are.
      const FitSetup theirs = fitter.SetupWith(smaller.released);
      Vector start = smaller.point;
      for (const int index : setup.free) {
        if (!theirs.IsFree(index)) start[index] = sets[i].point[index];
      }
      starts[i].push_back(std::move(start));
      starts[i].push_back(smaller.point);
    }
    Random random(Random::StreamSeed(seed, i));
    for (int draw = 0; i < kDrawnSets && draw < fitter.draws(); ++draw)
      starts[i].push_back(DrawStart(setup, sets[i].point, draw, random));
  }
  fitter.Fit(again, starts, SetFitter::kTolerance, SetFitter::kContinued);
  for (std::size_t i = 0; i < sets.size(); ++i) {
    if (again[i].fitted_error < sets[i].fitted_error) sets[i] = std::move(again[i]);
  }
}

FittedSet FitAround(const SetFitter& fitter, std::uint64_t seed, const FittedSet& one) {
  const FitSetup setup = fitter.SetupWith(one.released);
  const int draws = (fitter.draws() + static_cast<int>(kGroups) - 1) / static_cast<int>(kGroups);
  FittedSet best = one;
  int idle = 0;
  for (int round = 0; draws > 0 && round < kMaxRounds && idle < kIdleRounds && !fitter.Interrupted();
       ++round) {
    std::vector<FittedSet> groups(kGroups, best);
    std::vector<std::vector<Vector>> starts(kGroups);
    for (std::size_t g = 0; g < kGroups; ++g) {
      Random random(Random::StreamSeed(seed, static_cast<std::size_t>(round) * kGroups + g));
      for (int draw = 0; draw < draws; ++draw)
        starts[g].push_back(DrawStart(setup, best.point, static_cast<int>(g) + 2 * draw, random));
    }
    fitter.Fit(groups, starts, SetFitter::kTolerance, 1);
    const auto lowest = std::min_element(groups.begin(), groups.end(), FitsBetter);
    idle = lowest->fitted_error < kLower * best.fitted_error ? 0 : idle + 1;
    if (lowest->fitted_error < best.fitted_error) best = *lowest;
  }
  if (!(best.fitted_error < one.fitted_error)) return one;
  std::vector<FittedSet> judged{std::move(best)};
  fitter.LeaveOut(judged);
  return PredictsBetter(judged.front(), one) ? judged.front() : one;
}

}  // namespace sinew::diagnosis
