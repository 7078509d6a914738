// A search predicts millions of times: nothing may be allocated on the way. In a program of its own, because
// it counts what malloc is asked for.
#include <gtest/gtest.h>

#include "tests/problems/support/drive_bench.h"
#include "tests/support/allocation_counter.h"

namespace sinew {
namespace {

#ifdef SINEW_COUNTS_ALLOCATIONS

TEST(DriveAllocation, PredictAllocatesNothingInSteadyState) {
  std::vector<Bench> benches(2);
  benches[0].command = [](double t) { return std::sin(3 * t); };
  benches[1].input = "reference";
  benches[1].input_unit = "rad/s";
  benches[1].command = benches[0].command;
  benches[1].settings = "controller: {kind: pid_speed, kp: 1, control_period: 0.01}";
  for (const Bench& bench : benches) {
    const auto problem = BindBench(bench);
    Vector parameters = DrivePoint(*problem, {{"coulomb_torque", 0.1}});
    const std::vector<bool> all(problem->layout().size(), true);
    Prediction prediction(problem->layout());
    const auto workspace = problem->NewWorkspace();
    ASSERT_TRUE(problem->Predict({parameters, all, true, nullptr}, *workspace, prediction));
    const long before = Allocations();
    for (int i = 0; i < 3; ++i) {
      parameters[0] *= 1.01;
      ASSERT_TRUE(problem->Predict({parameters, all, true, nullptr}, *workspace, prediction));
      ASSERT_TRUE(problem->Predict({parameters, all, false, nullptr}, *workspace, prediction));
    }
    EXPECT_EQ(Allocations() - before, 0);
    const auto number = std::make_unique<double>(1);
    const void* volatile seen = number.get();  // else the compiler may leave the allocation out
    EXPECT_NE(seen, nullptr);
    EXPECT_EQ(Allocations() - before, 1) << "the counter counts";
  }
}

#else

TEST(DriveAllocation, IsCountedWithoutSanitizersOnly) {
  GTEST_SKIP() << "this build has an allocator of its own";
}

#endif

}  // namespace
}  // namespace sinew
