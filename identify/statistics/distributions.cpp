#include "identify/statistics/distributions.h"

#include <boost/math/distributions/students_t.hpp>
#include <boost/math/special_functions/beta.hpp>
#include <boost/math/special_functions/erf.hpp>
#include <boost/math/special_functions/gamma.hpp>
#include <cmath>

#include "base/constants.h"

namespace sinew::statistics {
namespace {

// Doubles as they are (Boost would compute in long double), and no exception at the edge of a domain: the
// functions below say what they return there.
using Policy = boost::math::policies::policy<
    boost::math::policies::promote_double<false>,
    boost::math::policies::domain_error<boost::math::policies::ignore_error>,
    boost::math::policies::overflow_error<boost::math::policies::ignore_error>,
    boost::math::policies::underflow_error<boost::math::policies::ignore_error>>;
constexpr Policy kPolicy;

}  // namespace

double ChiSquaredUpperTail(double x, double degrees_of_freedom) {
  if (!(x > 0)) return std::isnan(x) ? x : 1;
  if (std::isinf(x)) return 0;
  return boost::math::gamma_q(degrees_of_freedom / 2, x / 2, kPolicy);
}

double TwoSidedThreshold(double p) {
  if (!(p < 1)) return std::isnan(p) ? p : 0;
  if (!(p > 0)) return kInfinity;
  return std::sqrt(2.0) * boost::math::erfc_inv(p, kPolicy);
}

double StudentTCdf(double t, double degrees_of_freedom) {
  return cdf(boost::math::students_t_distribution<double, Policy>(degrees_of_freedom), t);
}

double StudentTQuantile(double probability, double degrees_of_freedom) {
  if (!(probability > 0 && probability < 1 && degrees_of_freedom > 0)) return kNaN;
  return quantile(boost::math::students_t_distribution<double, Policy>(degrees_of_freedom), probability);
}

double FUpperTail(double f, double first, double second) {
  if (!(f > 0)) return std::isnan(f) ? f : 1;
  if (std::isinf(f)) return 0;
  // Abramowitz, Stegun 1964, 26.6.2: of the smaller argument, so that the tail keeps its digits.
  return boost::math::ibeta(second / 2, first / 2, second / (second + first * f), kPolicy);
}

}  // namespace sinew::statistics
