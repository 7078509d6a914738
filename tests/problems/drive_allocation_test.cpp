// A search predicts millions of times: nothing may be allocated on the way. In a program of its own, because
// it counts what malloc is asked for.
#include <gtest/gtest.h>

#include <atomic>
#include <cstddef>

#include "tests/problems/support/drive_bench.h"

#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define SINEW_COUNTS_ALLOCATIONS

namespace {
std::atomic<long> allocations{0};
}  // namespace

extern "C" void* __libc_malloc(std::size_t size);  // NOLINT: the C library's name
extern "C" void* malloc(std::size_t size) noexcept {
  allocations.fetch_add(1, std::memory_order_relaxed);
  return __libc_malloc(size);
}
#endif

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
    const long before = allocations;
    for (int i = 0; i < 3; ++i) {
      parameters[0] *= 1.01;
      ASSERT_TRUE(problem->Predict({parameters, all, true, nullptr}, *workspace, prediction));
      ASSERT_TRUE(problem->Predict({parameters, all, false, nullptr}, *workspace, prediction));
    }
    EXPECT_EQ(allocations - before, 0);
    const auto number = std::make_unique<double>(1);
    EXPECT_EQ(allocations - before, 1) << "the counter counts";
  }
}

#else

TEST(DriveAllocation, IsCountedWithoutSanitizersOnly) {
  GTEST_SKIP() << "this build has an allocator of its own";
}

#endif

}  // namespace
}  // namespace sinew
