#include "problems/emg_shape/bursts.h"

#include <algorithm>

namespace sinew {
namespace {

constexpr double kBetweenBursts = 0.03;  // of the curve's range, by which a cut lies below both bursts

// Minima on the circle, each at least `depth` below the maxima on both sides; increasing.
std::vector<int> Valleys(const Vector& curve, double depth) {
  const auto n = static_cast<int>(curve.size());
  Eigen::Index lowest = 0;
  curve.minCoeff(&lowest);
  std::vector<int> valleys{static_cast<int>(lowest)};
  double peak = curve[lowest];
  int candidate = -1;  // lowest point since the peak
  for (int i = 1; i < n; ++i) {
    const int at = (static_cast<int>(lowest) + i) % n;
    const double value = curve[at];
    if (candidate < 0) {
      peak = std::max(peak, value);
      if (peak - curve[valleys.back()] > depth && peak - value > depth) candidate = at;
      continue;
    }
    if (value < curve[candidate]) candidate = at;
    if (value - curve[candidate] > depth) {
      valleys.push_back(candidate);
      candidate = -1;
      peak = value;
    }
  }
  std::sort(valleys.begin(), valleys.end());
  return valleys;
}

}  // namespace

std::vector<double> FindCuts(const Vector& curve) {
  const double depth = kBetweenBursts * (curve.maxCoeff() - curve.minCoeff());
  std::vector<double> cuts;
  for (const int valley : Valleys(curve, depth))
    cuts.push_back(static_cast<double>(valley) / static_cast<double>(curve.size()));
  return cuts;
}

int BurstOf(const std::vector<double>& cuts, int cycle, double phase) {
  if (cuts.empty()) return cycle;
  const auto past = std::upper_bound(cuts.begin(), cuts.end(), phase) - cuts.begin();
  return cycle * static_cast<int>(cuts.size()) + static_cast<int>(past);
}

}  // namespace sinew
