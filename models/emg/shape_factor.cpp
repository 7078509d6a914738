#include "models/emg/shape_factor.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/numbers.h"

namespace sinew {
namespace {

constexpr double kSameSpeed = 1e-9;

}  // namespace

Result<ShapeFactor> ShapeFactor::Fit(const std::vector<double>& speeds, const std::vector<double>& factors,
                                     FactorLaw law) {
  if (speeds.empty()) return Fail("no speeds, expected at least one");
  if (speeds.size() != factors.size())
    return Fail("{} speeds for {} factors, expected as many", speeds.size(), factors.size());
  for (std::size_t i = 0; i < speeds.size(); ++i) {
    if (!std::isfinite(speeds[i]) || !std::isfinite(factors[i]))
      return Fail("factor {} at speed {}: expected finite numbers", factors[i], speeds[i]);
  }
  std::vector<std::size_t> order(speeds.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return speeds[a] < speeds[b]; });
  ShapeFactor fit;
  fit.law_ = law;
  for (const std::size_t i : order) {
    if (!fit.speeds_.empty() && speeds[i] == fit.speeds_.back())
      return Fail("speed {} comes twice, expected its cycles together", Readable(speeds[i], 4));
    fit.speeds_.push_back(speeds[i]);
    fit.factors_.push_back(factors[i]);
  }

  const auto n = static_cast<double>(speeds.size());
  double mean_speed = 0;
  double mean_factor = 0;
  for (std::size_t i = 0; i < speeds.size(); ++i) {
    mean_speed += fit.speeds_[i] / n;
    mean_factor += fit.factors_[i] / n;
  }
  double square = 0;
  double product = 0;
  for (std::size_t i = 0; i < speeds.size(); ++i) {
    square += (fit.speeds_[i] - mean_speed) * (fit.speeds_[i] - mean_speed);
    product += (fit.speeds_[i] - mean_speed) * (fit.factors_[i] - mean_factor);
  }
  fit.slope_ = square > 0 ? product / square : 0;
  fit.intercept_ = mean_factor - fit.slope_ * mean_speed;
  if (speeds.size() > 2) {
    double sum = 0;
    for (std::size_t i = 0; i < speeds.size(); ++i) {
      const double off = fit.factors_[i] - fit.intercept_ - fit.slope_ * fit.speeds_[i];
      sum += off * off;
    }
    fit.scatter_ = std::sqrt(sum / (n - 2));
  }
  return fit;
}

double ShapeFactor::At(double speed) const {
  if (law_ == FactorLaw::kRegression) return std::max(0.0, intercept_ + slope_ * speed);
  if (!(speed > speeds_.front())) return std::max(0.0, factors_.front());
  if (speed >= speeds_.back()) return std::max(0.0, factors_.back());
  const auto right =
      static_cast<std::size_t>(std::upper_bound(speeds_.begin(), speeds_.end(), speed) - speeds_.begin());
  const double share = (speed - speeds_[right - 1]) / (speeds_[right] - speeds_[right - 1]);
  return std::max(0.0, factors_[right - 1] + share * (factors_[right] - factors_[right - 1]));
}

bool ShapeFactor::Covers(double speed) const {
  const double margin = kSameSpeed * std::max(std::abs(speeds_.front()), std::abs(speeds_.back()));
  return speed >= speeds_.front() - margin && speed <= speeds_.back() + margin;
}

}  // namespace sinew
