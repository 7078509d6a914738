#include "problems/contact/motion/level_feet.h"

#include <algorithm>

#include "base/median.h"

namespace sinew {
namespace {

constexpr double kFlatFrom = 0.2;
constexpr double kFlatTo = 0.45;

double FlatHeight(const Stance& stance) {
  std::vector<double> heights;
  const double duration = stance.loaded[1] - stance.loaded[0];
  for (std::size_t t = 0; t < stance.time.size(); ++t) {
    const double phase = (stance.time[t] - stance.loaded[0]) / duration;
    if (phase >= kFlatFrom && phase <= kFlatTo) heights.push_back(stance.foot.centre[t].y());
  }
  if (heights.empty()) heights.push_back(stance.foot.centre[stance.time.size() / 2].y());
  return UpperMedian(heights);
}

}  // namespace

std::vector<double> LevelFeet(std::vector<Stance>& stances) {
  const bool any =
      std::any_of(stances.begin(), stances.end(), [](const Stance& stance) { return stance.fitted; });
  double sum = 0;
  double count = 0;
  std::vector<double> raised;
  for (std::size_t s = 0; s < stances.size(); ++s) {
    raised.push_back(-FlatHeight(stances[s]));
    if (any && !stances[s].fitted) continue;
    sum -= raised.back();
    count += 1;
  }
  for (std::size_t s = 0; s < stances.size(); ++s) {
    raised[s] += sum / count;
    stances[s].foot.Raise(raised[s]);
  }
  return raised;
}

}  // namespace sinew
