#include "identify/solvers/local_fit.h"

#include <gtest/gtest.h>

#include <cmath>

#include "identify/role_view.h"
#include "tests/identify/support/function_problem.h"

namespace sinew {
namespace {

/// y = x, measured 1 and 3, rounded to steps of `grain` in x as an integrator's steps would: the slope is
/// that of the smooth line.
class NoisyCost : public FunctionProblem {
 public:
  NoisyCost(double steps, double stated) : stated_(stated) {
    Add("x", 0, 10, 7.3);
    AddBlock("one", {1, 3}, {0}, [steps](const Vector& p, Eigen::Ref<Vector> values, Matrix* derivatives) {
      const double wobble = steps > 0 ? steps * std::sin(p[0] / (steps * steps)) : 0;
      values.setConstant(p[0] + wobble);
      if (derivatives != nullptr) derivatives->setOnes();
      return Status();
    });
  }
  [[nodiscard]] double cost_noise_level() const override { return stated_; }

 private:
  double stated_;
};

// Without a stated noise level it increases its damping again and again for random changes of the cost.
TEST(LocalFitTest, StopsAtTheNoiseLevelOfTheCost) {
  const auto evaluations = [](const NoisyCost& problem) {
    const Fit prepared(problem);
    solvers::LocalFit fit(prepared.least_squares);
    const auto outcome = fit.Minimize(prepared.least_squares.Start(), -1, {0, 1e-12}, 60);
    EXPECT_TRUE(outcome.converged);
    EXPECT_NEAR(10 * outcome.x[0], 2, 0.2);
    return fit.evaluations();
  };
  const long told = evaluations(NoisyCost(1e-2, 1e-2));
  EXPECT_LT(3 * told, evaluations(NoisyCost(1e-2, 0)));
}

TEST(LocalFitTest, ARoleViewHasTheNoiseLevelOfItsProblem) {
  const NoisyCost problem(0, 0.25);
  const RoleView view(problem, [](const Block& block) { return block.role; });
  EXPECT_EQ(view.cost_noise_level(), 0.25);
}

}  // namespace
}  // namespace sinew
