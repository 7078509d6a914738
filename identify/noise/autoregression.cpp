#include "identify/noise/autoregression.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace sinew::noise {

namespace {

/// Durbin-Levinson step: the coefficients for one more sample, whose partial autocorrelation is `last`.
std::vector<double> Longer(const std::vector<double>& before, double last) {
  std::vector<double> a = before;
  for (std::size_t i = 0; i < a.size(); ++i) a[i] -= last * before[before.size() - 1 - i];
  a.push_back(last);
  return a;
}

}  // namespace

std::vector<double> CoefficientsFromPartial(const std::vector<double>& partial) {
  std::vector<double> a;
  for (const double last : partial) a = Longer(a, last);
  return a;
}

std::vector<double> PartialFromCoefficients(const std::vector<double>& coefficients) {
  std::vector<double> a = coefficients;
  std::vector<double> partial(a.size());
  for (std::size_t m = a.size(); m-- > 0;) {
    const double last = a[m];
    partial[m] = last;
    const std::vector<double> longer = a;
    for (std::size_t i = 0; i < m; ++i) a[i] = (longer[i] + last * longer[m - 1 - i]) / (1 - last * last);
  }
  return partial;
}

std::vector<double> BurgPartial(const std::vector<Vector>& stretches, int order) {
  std::vector<Vector> forward = stretches;   // error of predicting sample t from its past
  std::vector<Vector> backward = stretches;  // error of predicting sample t - m from its future
  std::vector<double> partial;
  for (int m = 1; m <= order; ++m) {
    double product = 0;
    double power = 0;
    for (std::size_t s = 0; s < forward.size(); ++s) {
      const Eigen::Index n = forward[s].size();
      if (n < 2) continue;
      const auto f = forward[s].tail(n - 1);
      const auto b = backward[s].head(n - 1);
      product += f.dot(b);
      power += f.squaredNorm() + b.squaredNorm();
    }
    const double last = power > 0 ? 2 * product / power : 0;
    partial.push_back(last);
    for (std::size_t s = 0; s < forward.size(); ++s) {
      const Eigen::Index n = forward[s].size();
      if (n < 2) {
        forward[s].resize(0);
        backward[s].resize(0);
        continue;
      }
      const Vector f = forward[s].tail(n - 1) - last * backward[s].head(n - 1);
      const Vector b = backward[s].head(n - 1) - last * forward[s].tail(n - 1);
      forward[s] = f;
      backward[s] = b;
    }
  }
  return partial;
}

AutoregressiveFilter::AutoregressiveFilter(const std::vector<double>& partial)
    : predictors_(1), scale_(partial.size() + 1, 1) {
  for (const double last : partial) predictors_.push_back(Longer(predictors_.back(), last));
  for (std::size_t t = partial.size(); t-- > 0;) {
    scale_[t] = scale_[t + 1] * std::sqrt(std::max(0.0, 1 - partial[t] * partial[t]));
  }
}

void AutoregressiveFilter::Apply(double* x, Eigen::Index n) const {
  const Eigen::Index p = order();
  for (Eigen::Index t = n - 1; t >= 0;
       --t) {  // from the last sample, because earlier ones are still needed unfiltered
    const Eigen::Index known = std::min(t, p);
    const double* a = predictors_[static_cast<std::size_t>(known)].data();
    double error = x[t];
    for (Eigen::Index i = 0; i < known; ++i) error -= a[i] * x[t - 1 - i];
    x[t] = error * scale_[static_cast<std::size_t>(known)];
  }
}

double AutoregressiveFilter::LogDeterminant(Eigen::Index n) const {
  double sum = 0;
  for (Eigen::Index t = 0; t < std::min<Eigen::Index>(n, order()); ++t) {
    sum -= 2 * std::log(scale_[static_cast<std::size_t>(t)]);
  }
  return sum;
}

}  // namespace sinew::noise
