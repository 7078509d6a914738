#include "identify/uncertainty/independence.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "identify/statistics/distributions.h"

namespace sinew::uncertainty {
namespace {

constexpr double kLevel = 0.05;
constexpr std::array<int, 2> kLags{1, 10};
constexpr double kFewestSamples = 30;

/// p-value of no autocorrelation up to a lag, over all series of a channel.
double LjungBox(const std::vector<Vector>& series, int lags) {
  double samples = 0;
  double squares = 0;
  for (const Vector& s : series) {
    samples += static_cast<double>(s.size());
    squares += s.squaredNorm();
  }
  if (!(squares > 0)) return 1;
  double statistic = 0;
  for (int lag = 1; lag <= lags; ++lag) {
    double pairs = 0;
    double count = 0;
    for (const Vector& s : series) {
      const Eigen::Index n = s.size() - lag;
      if (n <= 0) continue;
      pairs += s.head(n).dot(s.tail(n));
      count += static_cast<double>(n);
    }
    if (count > 0) statistic += samples * (samples + 2) * std::pow(pairs / squares, 2) / count;
  }
  return statistics::ChiSquaredUpperTail(statistic, lags);
}

// Squares about their mean.
std::vector<Vector> Squared(std::vector<Vector> series) {
  double sum = 0;
  double samples = 0;
  for (const Vector& s : series) {
    sum += s.squaredNorm();
    samples += static_cast<double>(s.size());
  }
  for (Vector& s : series) s = (s.array().square() - sum / samples).matrix();
  return series;
}

}  // namespace

bool ResidualsLookIndependent(const LeastSquares& problem, const Linearization& at) {
  std::map<std::string, std::vector<Vector>> series_of;
  for (const Linearization::Rows& rows : at.blocks) {
    const Block& block = problem.problem().layout()[static_cast<std::size_t>(rows.block)];
    series_of[block.channel].emplace_back(at.residuals.segment(rows.first, rows.count));
  }
  const double level = kLevel / (2.0 * kLags.size() * static_cast<double>(series_of.size()));
  for (const auto& [channel, series] : series_of) {
    double samples = 0;
    for (const Vector& s : series) samples += static_cast<double>(s.size());
    if (samples < kFewestSamples) return false;
    const std::vector<Vector> squared = Squared(series);
    for (const int lags : kLags) {
      if (LjungBox(series, lags) < level || LjungBox(squared, lags) < level) return false;
    }
  }
  return true;
}

}  // namespace sinew::uncertainty
