#include "problems/emg_shape/averaging_problem.h"

#include <gtest/gtest.h>

#include "tests/problems/emg_shape/emg_shape_study.h"
#include "tests/problems/support/jacobian_check.h"

namespace sinew {
namespace {

std::unique_ptr<AveragingProblem> BoundAveraging(const Dataset& data) {
  auto problem = AveragingProblem::Make(data, EmgSettings(", model: averaging"));
  EXPECT_TRUE(problem) << problem.error().message;
  return problem ? std::move(*problem) : nullptr;
}

// `simulate` at the starts is the thesis's averaging, sample by sample.
TEST(AveragingProblem, RestsAtTheThesissModel) {
  const auto problem = BoundAveraging(EmgStudy());
  Prediction prediction(problem->layout());
  const auto workspace = problem->NewWorkspace();
  const std::vector<bool> all(problem->layout().size(), true);
  ASSERT_TRUE(problem->Predict({RestPoint(*problem), all, false, nullptr}, *workspace, prediction));
  for (const EmgShapeTrial& trial : problem->data().trials) {
    for (std::size_t m = 0; m < 2; ++m) {
      const auto values = prediction.values(trial.first_block + static_cast<int>(m));
      for (std::size_t i = 0; i < trial.time.size(); ++i) {
        if (trial.phase[i] < 0 || trial.phase[i] >= 1) continue;
        EXPECT_NEAR(values[static_cast<Eigen::Index>(i)], problem->model().At(m, trial.speed, trial.phase[i]),
                    1e-12);
      }
    }
  }
}

TEST(AveragingProblem, DerivativesAgreeWithDifferences) {
  const auto problem = BoundAveraging(EmgStudy());
  Random random(4);
  ExpectJacobianAgrees(*problem, random);
}

TEST(AveragingProblem, OneSpeedHasNoSlope) {
  const auto problem = BoundAveraging(EmgStudy({{"speeds", 1}}));
  EXPECT_EQ(problem->parameters().size(), 2U);
  EXPECT_FALSE(FindParameter(problem->parameters(), "lat_gas_r.factor_slope"));
}

}  // namespace
}  // namespace sinew
