// The random numbers of simann.f.
#pragma once

#include <array>

namespace sinew {

/// RANMAR: uniform numbers of 24 bits. Marsaglia, Zaman (1987), Toward a Universal Random Number Generator,
/// FSU-SCRI-87-50; James (1990), Comput. Phys. Commun. 60:329-344. Single precision throughout, as published.
class Ranmar {
 public:
  /// @param ij [0..31328] @param kl [0..30081]
  Ranmar(int ij, int kl) {
    int i = ij / 177 % 177 + 2;
    int j = ij % 177 + 2;
    int k = kl / 169 % 178 + 1;
    int l = kl % 169;
    for (float& u : u_) {
      u = 0;
      float bit = 0.5f;
      for (int n = 0; n < 24; ++n, bit *= 0.5f) {
        const int m = i * j % 179 * k % 179;
        i = j;
        j = k;
        k = m;
        l = (53 * l + 1) % 169;
        if (l * m % 64 >= 32) u += bit;
      }
    }
  }

  float operator()() {
    float uniform = u_[i_] - u_[j_];
    if (uniform < 0) uniform += 1;
    u_[i_] = uniform;
    i_ = i_ == 0 ? u_.size() - 1 : i_ - 1;
    j_ = j_ == 0 ? u_.size() - 1 : j_ - 1;
    c_ -= 7654321.0f / 16777216.0f;
    if (c_ < 0) c_ += 16777213.0f / 16777216.0f;
    uniform -= c_;
    return uniform < 0 ? uniform + 1 : uniform;
  }

 private:
  std::array<float, 97> u_{};
  std::size_t i_ = 96;
  std::size_t j_ = 32;
  float c_ = 362436.0f / 16777216.0f;
};

}  // namespace sinew
