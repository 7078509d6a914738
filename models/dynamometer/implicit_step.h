// An implicit Runge-Kutta step of three stages, order 3, stable however stiff the equations are.
//
//   x_i = x + h sum_j a_ij f(x_j),  a_ii = g;  the last stage is the next state
//
// Source: Alexander (1977), SIAM J. Numer. Anal. 14:1006-1021, theorem 5.
#pragma once

#include <array>

namespace sinew {

struct ImplicitStep {
  static constexpr int kStages = 3;
  static constexpr double kDiagonal = 0.43586652150845899942;  // g: root of x^3 - 3 x^2 + 3/2 x - 1/6
  static constexpr std::array<double, kStages> kNodes{kDiagonal, 0.5 * (1 + kDiagonal), 1};
  // Below the diagonal.
  static constexpr double kWeights[kStages][2] = {
      {0, 0},
      {0.5 * (1 - kDiagonal), 0},
      {-0.25 * ((6 * kDiagonal - 16) * kDiagonal + 1), 0.25 * ((6 * kDiagonal - 20) * kDiagonal + 5)}};
};

/// One state through a step: what a stage knows of it before it is solved, x_i = past + h g f(x_i).
template <class T>
struct StagedState {
  T begin{0.0};
  std::array<T, ImplicitStep::kStages> slope{};

  [[nodiscard]] T Past(int stage, double h) const {
    T past = begin;
    for (int j = 0; j < stage; ++j)
      past += (h * ImplicitStep::kWeights[stage][j]) * slope[static_cast<std::size_t>(j)];
    return past;
  }
};

}  // namespace sinew
