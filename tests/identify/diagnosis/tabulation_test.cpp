#include "identify/diagnosis/tabulation.h"

#include <gtest/gtest.h>

#include <limits>

namespace sinew::diagnosis {
namespace {

DiagnosedParameter Size(double value, double lower, double upper, double before = 0) {
  DiagnosedParameter size;
  size.value = value;
  size.std_error = (upper - lower) / 4;
  size.ci95 = {lower, upper};
  size.before = before;
  return size;
}

DiagnosedParameter Undetermined(double value, const std::string& bound) {
  DiagnosedParameter size;
  size.value = value;
  size.std_error = std::numeric_limits<double>::quiet_NaN();
  size.ci95 = {size.std_error, size.std_error};
  size.at_bound = bound;
  return size;
}

TEST(NoneExcludesNull, OneIntervalThatExcludesItIsEnough) {
  EXPECT_TRUE(NoneExcludesNull({Size(1, -1, 3)}));
  EXPECT_TRUE(NoneExcludesNull({Size(0.01, 0, 0.17)})) << "an interval that a bound cuts off at the null";
  EXPECT_TRUE(NoneExcludesNull({Size(1.1, 0.9, 1.3, 1)})) << "a gain";
  EXPECT_FALSE(NoneExcludesNull({Size(2, 1, 3)}));
  EXPECT_FALSE(NoneExcludesNull({Size(0.01, 0, 0.17), Size(0.4, 0.3, 0.5)}));
}

TEST(NoneExcludesNull, ABoundOtherThanTheNullExcludesIt) {
  EXPECT_FALSE(NoneExcludesNull({Undetermined(5, "upper")}));
  EXPECT_TRUE(NoneExcludesNull({Undetermined(0, "lower")}));
  EXPECT_TRUE(NoneExcludesNull({Undetermined(0.3, "")})) << "no data respond to it";
  EXPECT_FALSE(NoneExcludesNull({})) << "a cause without a size, as rounding";
}

}  // namespace
}  // namespace sinew::diagnosis
