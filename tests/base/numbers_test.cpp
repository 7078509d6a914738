#include "base/numbers.h"

#include <gtest/gtest.h>

#include "base/constants.h"

namespace sinew {
namespace {

TEST(WholeNumber, IsWhatADoubleHoldsExactly) {
  EXPECT_EQ(WholeNumber(0), 0);
  EXPECT_EQ(WholeNumber(-0.0), 0);
  EXPECT_EQ(WholeNumber(-3), -3);
  EXPECT_EQ(WholeNumber(9007199254740992.0), 9007199254740992);
  for (const double none : {0.5, -1e-300, 1e16, 1e300, kInfinity, -kInfinity, kNaN})
    EXPECT_FALSE(WholeNumber(none)) << none;
}

}  // namespace
}  // namespace sinew
