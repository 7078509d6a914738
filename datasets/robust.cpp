#include "datasets/robust.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "datasets/order_statistics.h"

namespace sinew {

double Quantile(const std::vector<double>& values, double share) {
  return QuantileOf(share, [&](auto add) {
    for (const double value : values) add(value);
  });
}

double Median(const std::vector<double>& values) {
  return Quantile(values, 0.5);
}

double RobustDeviation(const std::vector<double>& values) {
  return RobustDeviationOf([&](auto add) {
    for (const double value : values) add(value);
  });
}

std::vector<double> Finite(const std::vector<double>& values) {
  std::vector<double> finite;
  finite.reserve(values.size());
  std::copy_if(values.begin(), values.end(), std::back_inserter(finite),
               [](double value) { return std::isfinite(value); });
  return finite;
}

double Correlation(const std::vector<double>& a, const std::vector<double>& b) {
  double n = 0;
  double mean_a = 0;
  double mean_b = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (!std::isfinite(a[i] + b[i])) continue;
    n += 1;
    mean_a += a[i];
    mean_b += b[i];
  }
  if (n < 2) return std::numeric_limits<double>::quiet_NaN();
  mean_a /= n;
  mean_b /= n;
  double aa = 0;
  double bb = 0;
  double ab = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (!std::isfinite(a[i] + b[i])) continue;
    aa += (a[i] - mean_a) * (a[i] - mean_a);
    bb += (b[i] - mean_b) * (b[i] - mean_b);
    ab += (a[i] - mean_a) * (b[i] - mean_b);
  }
  return aa > 0 && bb > 0 ? ab / std::sqrt(aa * bb) : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace sinew
