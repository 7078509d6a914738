// Length and moment arm of a muscle that crosses the ankle.
//
//   arm(q) = a0 + a1 q + a2 q^2 ...,  length(q) = length at 0 - integral of arm
#pragma once

#include <vector>

namespace sinew {

struct MusclePath {
  double length_at_zero = 0.3;  ///< of muscle and tendon [m]
  std::vector<double> arm;      ///< coefficients, positive: the muscle dorsiflexes [m, m/rad, ...]

  template <class T>
  [[nodiscard]] T Arm(const T& angle) const {
    T sum(0.0);
    for (std::size_t k = arm.size(); k-- > 0;) sum = sum * angle + arm[k];
    return sum;
  }
  template <class T>
  [[nodiscard]] T Length(const T& angle) const {
    T sum(0.0);
    for (std::size_t k = arm.size(); k-- > 0;) sum = sum * angle + arm[k] / static_cast<double>(k + 1);
    return length_at_zero - sum * angle;
  }
};

}  // namespace sinew
