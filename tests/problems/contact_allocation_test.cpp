// A search predicts millions of times: nothing may be allocated on the way.
#include <gtest/gtest.h>

#include <atomic>
#include <cstddef>

#include "base/random.h"
#include "identify/fit_setup.h"
#include "identify/least_squares.h"
#include "tests/problems/support/jacobian_check.h"
#include "tests/problems/support/stepping_data.h"

// Sanitizers bring an allocator of their own, which cannot be counted this way.
#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define SINEW_COUNTS_ALLOCATIONS

namespace {
std::atomic<long> allocations{0};
}  // namespace

// Stands before the C library's: operator new ends here, and so does Eigen, which calls malloc itself.
extern "C" void* __libc_malloc(std::size_t size);  // NOLINT: the C library's name
extern "C" void* malloc(std::size_t size) noexcept {
  allocations.fetch_add(1, std::memory_order_relaxed);
  return __libc_malloc(size);
}
#endif

namespace sinew {
namespace {

#ifdef SINEW_COUNTS_ALLOCATIONS

TEST(ContactAllocation, TheCounterCounts) {
  const long before = allocations;
  Vector vector(1000);
  vector.setZero();
  const auto number = std::make_unique<double>(vector.sum());
  EXPECT_EQ(*number, 0);
  EXPECT_GE(allocations - before, 2);
}

TEST(ContactAllocation, PredictAllocatesNothingInSteadyState) {
  for (const std::string& settings :
       {SettingsText(ExactData(), kFitsVertical, kFitsForce), std::string(kHeelAndForefoot)}) {
    const auto problem = MakeContact(ExactData(), settings).value();
    Prediction prediction(problem->layout());
    const auto workspace = problem->NewWorkspace();
    const std::vector<bool> all(problem->layout().size(), true);
    Random random(1);
    Vector parameters = RandomInside(*problem, 0, random);
    ASSERT_TRUE(problem->Predict({parameters, all, true, nullptr}, *workspace, prediction));
    const long before = allocations;
    for (int i = 0; i < 5; ++i) {
      parameters[0] *= 1.01;
      ASSERT_TRUE(problem->Predict({parameters, all, true, nullptr}, *workspace, prediction));
    }
    EXPECT_EQ(allocations - before, 0);
  }
}

TEST(ContactAllocation, LeastSquaresAllocatesNothingInSteadyState) {
  const auto problem = MakeContact(ExactData(), SettingsText(ExactData())).value();
  const FitSetup setup = MakeFitSetup(*problem, {}).value();
  const LeastSquares fit(*problem, setup);
  auto workspace = fit.NewWorkspace();
  auto jacobian = fit.NewJacobian();
  Vector residuals;
  Vector x = fit.Start();
  ASSERT_TRUE(fit.Evaluate(x, workspace, residuals, &jacobian));
  const long before = allocations;
  x[0] += 0.01;
  ASSERT_TRUE(fit.Evaluate(x, workspace, residuals, &jacobian));
  EXPECT_EQ(allocations - before, 0);
}

#else

TEST(ContactAllocation, IsCountedWithoutSanitizersOnly) {
  GTEST_SKIP() << "this build has an allocator of its own";
}

#endif

}  // namespace
}  // namespace sinew
