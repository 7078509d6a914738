// A search predicts millions of times: nothing may be allocated on the way.
#include <gtest/gtest.h>

#include "base/random.h"
#include "identify/fit_setup.h"
#include "identify/least_squares.h"
#include "tests/problems/support/jacobian_check.h"
#include "tests/problems/support/stepping_data.h"
#include "tests/support/allocation_counter.h"

namespace sinew {
namespace {

#ifdef SINEW_COUNTS_ALLOCATIONS

TEST(ContactAllocation, TheCounterCounts) {
  const long before = Allocations();
  Vector vector(1000);
  vector.setZero();
  const auto number = std::make_unique<double>(vector.sum());
  const void* volatile seen = vector.data();  // else the compiler may leave both allocations out
  seen = number.get();
  EXPECT_NE(seen, nullptr);
  EXPECT_EQ(*number, 0);
  EXPECT_GE(Allocations() - before, 2);
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
    const long before = Allocations();
    for (int i = 0; i < 5; ++i) {
      parameters[0] *= 1.01;
      ASSERT_TRUE(problem->Predict({parameters, all, true, nullptr}, *workspace, prediction));
    }
    EXPECT_EQ(Allocations() - before, 0);
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
  const long before = Allocations();
  x[0] += 0.01;
  ASSERT_TRUE(fit.Evaluate(x, workspace, residuals, &jacobian));
  EXPECT_EQ(Allocations() - before, 0);
}

#else

TEST(ContactAllocation, IsCountedWithoutSanitizersOnly) {
  GTEST_SKIP() << "this build has an allocator of its own";
}

#endif

}  // namespace
}  // namespace sinew
