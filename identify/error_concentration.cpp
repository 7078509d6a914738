#include "identify/error_concentration.h"

#include <algorithm>
#include <cmath>

namespace sinew {
namespace {

constexpr int kMinSamples = 200;
constexpr int kStretches = 20;
constexpr double kMinConcentratedShare = 0.25;
constexpr double kRatioToOthers = 2;  // least ratio to any stretch that does not overlap it

// Largest sum of `count` neighbours that begin in [from, to), and where it begins.
std::pair<double, Eigen::Index> Largest(const Vector& sums, Eigen::Index count, Eigen::Index from,
                                        Eigen::Index to) {
  std::pair<double, Eigen::Index> largest{0, from};
  for (Eigen::Index i = from; i < to; ++i) {
    const double sum = sums[i + count] - sums[i];
    if (sum > largest.first) largest = {sum, i};
  }
  return largest;
}

// Whether the errors grow by at least a fifth from each quarter to the next. @param sums cumulative
bool Grows(const Vector& sums) {
  constexpr int kQuarters = 4;
  constexpr double kGrowth = 1.2;
  const Eigen::Index n = sums.size() - 1;
  double before = 0;
  for (int q = 0; q < kQuarters; ++q) {
    const double here = sums[n * (q + 1) / kQuarters] - sums[n * q / kQuarters];
    if (q > 0 && !(here > kGrowth * before)) return false;
    before = here;
  }
  return true;
}

}  // namespace

std::vector<Concentration> FindConcentrations(const Layout& layout, const std::vector<Vector>& values) {
  std::vector<Concentration> found;
  for (std::size_t b = 0; b < layout.size(); ++b) {
    const Block& block = layout[b];
    const Eigen::Index n = block.samples();
    if (n < kMinSamples || block.role == BlockRole::kPredicted) continue;
    Vector sums = Vector::Zero(n + 1);  // cumulative sums
    for (Eigen::Index i = 0; i < n; ++i) {
      const auto at = static_cast<std::size_t>(i);
      sums[i + 1] = sums[i] + std::pow(values[b][block.sample[at]] - block.measured[at], 2);
    }
    const Eigen::Index count = n / kStretches;
    const auto [most, first] = Largest(sums, count, 0, n - count + 1);
    if (!(most > kMinConcentratedShare * sums[n])) continue;
    const double others =
        std::max(Largest(sums, count, 0, std::max<Eigen::Index>(first - count + 1, 0)).first,
                 Largest(sums, count, std::min(first + count, n - count + 1), n - count + 1).first);
    if (most < kRatioToOthers * others) continue;
    const auto time = [&](Eigen::Index i) {
      return block.prediction_time[static_cast<std::size_t>(block.sample[static_cast<std::size_t>(i)])];
    };
    const double from = time(first);
    const double to = time(first + count - 1);
    const bool drift = first + count > n - count && Grows(sums);
    found.push_back({block.trial, block.channel, 0.5 * (from + to), to - from, most / sums[n], drift, {}});
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const Concentration& a, const Concentration& b) { return a.share > b.share; });
  std::vector<Concentration> combined;
  for (Concentration& one : found) {
    const auto same = std::find_if(combined.begin(), combined.end(),
                                   [&](const Concentration& c) { return c.drift == one.drift; });
    if (same == combined.end()) {
      combined.push_back(std::move(one));
    } else {
      same->others.push_back(std::move(one));
    }
  }
  return combined;
}

Warning ToWarning(const Concentration& c) {
  Warning warning{c.drift ? WarningKind::kErrorDrift : WarningKind::kErrorConcentration,
                  {c.channel, c.trial},
                  {c.share, c.width, c.time},
                  {}};
  for (const Concentration& other : c.others) {
    warning.names.insert(warning.names.end(), {other.channel, other.trial});
    warning.numbers.insert(warning.numbers.end(), {other.share, other.width, other.time});
  }
  return warning;
}

}  // namespace sinew
