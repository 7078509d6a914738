#include "problems/contact/phase_shape.h"

#include <cmath>

#include "base/constants.h"

namespace sinew {

PhaseShare PhaseShareAt(double time, const std::array<double, 2>& loaded) {
  constexpr double kApart = 1.0 / (kShapePhases + 1);  // of the phase
  PhaseShare share;
  const double duration = loaded[1] - loaded[0];
  if (!(duration > 0)) return share;
  const double phase = (time - loaded[0]) / duration;
  for (std::size_t j = 0; j < kShapePhases; ++j) {
    const double from_middle = phase / kApart - static_cast<double>(j + 1);
    if (!(std::abs(from_middle) < 1)) continue;
    share.value[j] = 0.5 * (1 + std::cos(kPi * from_middle));
    share.rate[j] = -0.5 * kPi / (kApart * duration) * std::sin(kPi * from_middle);
  }
  return share;
}

std::vector<double> AheadOfMiddle(const std::vector<double>& along, double heel, double toe) {
  const double middle = 0.5 * (heel + toe);
  std::vector<double> ahead;
  ahead.reserve(along.size());
  for (const double at : along) ahead.push_back(at - middle);
  return ahead;
}

}  // namespace sinew
