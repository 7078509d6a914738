#include "models/mechanisms/mechanism_error.h"

#include <gtest/gtest.h>

namespace sinew {
namespace {

TEST(MechanismError, IsThatOfTheThesis) {
  Mechanism mechanism;
  mechanism.threshold = 0.1;
  const MechanismReference reference{"", 0, {{{0, 1}, {2, 0.01}}, {{1, 2}, {-4, 1}}}};
  MechanismRun run;
  run.values.resize(3, 2);
  run.values << 2.2, 9,  //
      0.03, -4.4,        //
      9, 1;
  const MechanismError error = ErrorOf(mechanism, run, {0, 1, 2}, reference);
  // Coordinate 1: 0.2 / 2 and 0.02 / 0.1; coordinate 2: 0.4 / 4 and 0.
  EXPECT_NEAR(error.total, std::sqrt(((0.01 + 0.04) / 2 + 0.01 / 2) / 2), 1e-12);
  EXPECT_NEAR(error.rmse[0], std::sqrt((0.04 + 0.0004) / 2), 1e-12);
  EXPECT_NEAR(error.peak[0], 0.2, 1e-12);
  EXPECT_NEAR(error.peak[1], 0.4, 1e-12);
}

}  // namespace
}  // namespace sinew
