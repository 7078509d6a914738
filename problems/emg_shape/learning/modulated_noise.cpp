#include "problems/emg_shape/learning/modulated_noise.h"

#include <algorithm>
#include <cmath>

namespace sinew {
namespace {

constexpr int kVarianceSweeps = 30;
constexpr double kMinQuiet = 1e-4;  // share of the mean square

}  // namespace

double ModulatedNoise::At(double emg) const {
  return std::hypot(quiet, growth * emg);
}

ModulatedNoise FitModulatedNoise(const std::vector<double>& squares, const std::vector<double>& emg) {
  double mean = 0;
  for (const double square : squares) mean += square / static_cast<double>(squares.size());
  double quiet = mean;
  double growth = 0;
  for (int sweep = 0; sweep < kVarianceSweeps && mean > 0; ++sweep) {
    double w = 0;
    double e = 0;
    double ee = 0;
    double r = 0;
    double er = 0;
    for (std::size_t i = 0; i < squares.size(); ++i) {
      const double power = emg[i] * emg[i];
      const double variance = quiet + growth * power;
      const double weight = 1 / (variance * variance);
      w += weight;
      e += weight * power;
      ee += weight * power * power;
      r += weight * squares[i];
      er += weight * power * squares[i];
    }
    const double spread = w * ee - e * e;
    growth = spread > 0 ? std::clamp((w * er - e * r) / spread, 0.0, er / ee) : 0;
    quiet = std::max((r - growth * e) / w, kMinQuiet * mean);
  }
  return {std::sqrt(quiet), std::sqrt(growth)};
}

}  // namespace sinew
