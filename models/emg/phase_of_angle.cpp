#include "models/emg/phase_of_angle.h"

#include <algorithm>
#include <cmath>

namespace sinew {
namespace {

void Level(std::vector<double>& values) {
  for (std::size_t k = 1; k < values.size(); ++k) values[k] = std::max(values[k], values[k - 1]);
}

// Samples from the first one to where the value is reached.
double Place(const std::vector<double>& rising, double value) {
  if (!(value > rising.front())) return 0;
  const auto right = std::lower_bound(rising.begin(), rising.end(), value);
  if (right == rising.end()) return static_cast<double>(rising.size() - 1);
  const double share = (value - *(right - 1)) / (*right - *(right - 1));
  return static_cast<double>(right - rising.begin() - 1) + share;
}

}  // namespace

Result<PhaseOfAngle> PhaseOfAngle::Fit(const std::vector<double>& angle) {
  if (angle.size() < 3) return Fail("{} samples of the angle, expected at least 3", angle.size());
  for (std::size_t k = 0; k < angle.size(); ++k)
    if (!std::isfinite(angle[k])) return Fail("angle {} is {}, expected a finite number", k, angle[k]);
  const double ends = 0.5 * angle.front() + 0.5 * angle.back();
  const auto [low, high] = std::minmax_element(angle.begin(), angle.end());
  const bool rises = *high - ends > ends - *low;
  const auto reversal = static_cast<std::size_t>((rises ? high : low) - angle.begin());
  if (!(*high > *low)) return Fail("the angle never changes, expected a movement");
  if (reversal == 0 || reversal + 1 == angle.size())
    return Fail("the angle has no turning point within the cycle");
  PhaseOfAngle phase;
  phase.sign_ = rises ? 1 : -1;
  phase.step_ = 1 / static_cast<double>(angle.size() - 1);
  phase.reversal_ = static_cast<double>(reversal) * phase.step_;
  for (std::size_t k = 0; k <= reversal; ++k) phase.there_.push_back(phase.sign_ * angle[k]);
  for (std::size_t k = angle.size(); k-- > reversal;) phase.back_.push_back(phase.sign_ * angle[k]);
  Level(phase.there_);
  Level(phase.back_);
  return phase;
}

double PhaseOfAngle::At(double angle, bool before_reversal) const {
  return before_reversal ? step_ * Place(there_, sign_ * angle) : 1 - step_ * Place(back_, sign_ * angle);
}

}  // namespace sinew
