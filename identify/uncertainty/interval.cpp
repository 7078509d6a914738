#include "identify/uncertainty/interval.h"

#include <algorithm>

namespace sinew::uncertainty {

Interval MakeInterval(const LeastSquares& problem, const Vector& x, int variable, double lower_x,
                      double upper_x) {
  const int parameter = problem.setup().free[static_cast<std::size_t>(variable)];
  Interval interval;
  interval.lower_open = lower_x <= 0;
  interval.upper_open = upper_x >= 1;
  interval.lower_x = std::max(lower_x, 0.0);
  interval.upper_x = std::min(upper_x, 1.0);
  Vector end = x;
  end[variable] = interval.lower_x;
  interval.lower = problem.Parameters(end)[parameter];
  end[variable] = interval.upper_x;
  interval.upper = problem.Parameters(end)[parameter];
  return interval;
}

Interval LinearInterval(const LeastSquares& problem, const Vector& x, int variable, double half_width) {
  return MakeInterval(problem, x, variable, x[variable] - half_width, x[variable] + half_width);
}

}  // namespace sinew::uncertainty
