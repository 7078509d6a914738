#include "problems/contact/laboratory/smooth_errors.h"

#include <cmath>

namespace sinew {

SmoothErrors::SmoothErrors(double position, double rotation, double correlation_time, Random& random) {
  for (std::size_t c = 0; c < waves_.size(); ++c) {
    const double size = (c < 3 ? position : rotation) / std::sqrt(static_cast<double>(kWaves));
    for (Wave& wave : waves_[c]) {
      wave.frequency = random.Normal() / correlation_time;
      wave.cosine = size * random.Normal();
      wave.sine = size * random.Normal();
    }
  }
}

FootError SmoothErrors::At(double time) const {
  std::array<double, 6> value{};
  for (std::size_t c = 0; c < waves_.size(); ++c) {
    for (const Wave& wave : waves_[c])
      value[c] += wave.cosine * std::cos(wave.frequency * time) + wave.sine * std::sin(wave.frequency * time);
  }
  return {Vec3(value[0], value[1], value[2]), Vec3(value[3], value[4], value[5])};
}

}  // namespace sinew
