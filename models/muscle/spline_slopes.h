// Slopes at the samples of the cubic spline without knots at the second and the last but one sample ("not a
// knot", de Boor 1978, ch. IV): a linear function of the samples, for any kind of number.
#pragma once

#include <vector>

namespace sinew {

/// @param time [N >= 1, increasing] @param values [N] @return [N]; 0 for one sample, the line's slope for
/// two, the parabola's for three.
template <class T>
std::vector<T> SplineSlopes(const std::vector<double>& time, const std::vector<T>& values) {
  const std::size_t n = time.size();
  std::vector<T> slopes(n, T(0.0));
  if (n < 2) return slopes;
  std::vector<double> h;
  std::vector<T> rise;
  for (std::size_t i = 0; i + 1 < n; ++i) {
    h.push_back(time[i + 1] - time[i]);
    rise.push_back((1 / h.back()) * (values[i + 1] - values[i]));
  }
  if (n == 2) {
    slopes[0] = slopes[1] = rise[0];
    return slopes;
  }
  if (n == 3) {
    const T bend = (1 / (h[0] + h[1])) * (rise[1] - rise[0]);
    slopes[0] = rise[0] - h[0] * bend;
    slopes[1] = rise[0] + h[0] * bend;
    slopes[2] = rise[1] + h[1] * bend;
    return slopes;
  }
  // Rows: lower s_{i-1} + diagonal s_i + upper s_{i+1} = right.
  std::vector<double> upper(n, 0);
  const double first = h[0] + h[1];
  double diagonal = h[1];
  upper[0] = first / diagonal;
  slopes[0] = (1 / (first * diagonal)) * (((h[0] + 2 * first) * h[1]) * rise[0] + (h[0] * h[0]) * rise[1]);
  for (std::size_t i = 1; i + 1 < n; ++i) {
    diagonal = 2 * (h[i - 1] + h[i]) - h[i] * upper[i - 1];
    upper[i] = h[i - 1] / diagonal;
    slopes[i] = (1 / diagonal) * ((3 * h[i]) * rise[i - 1] + (3 * h[i - 1]) * rise[i] - h[i] * slopes[i - 1]);
  }
  const double last = h[n - 2] + h[n - 3];
  diagonal = h[n - 3] - last * upper[n - 2];
  slopes[n - 1] =
      (1 / diagonal) *
      ((1 / last) * ((h[n - 2] * h[n - 2]) * rise[n - 3] + ((2 * last + h[n - 2]) * h[n - 3]) * rise[n - 2]) -
       last * slopes[n - 2]);
  for (std::size_t i = n - 1; i-- > 0;) slopes[i] = slopes[i] - upper[i] * slopes[i + 1];
  return slopes;
}

}  // namespace sinew
