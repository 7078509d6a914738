#include "identify/identification/stepwise.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/identify/support/error_of.h"
#include "tests/identify/support/function_problem.h"

namespace sinew {
namespace {

using testing::HasSubstr;

// Trial "first" measures a, trial "second" a + b.
class Sum final : public FunctionProblem {
 public:
  Sum() {
    Add("a", 0, 10, 1).Add("b", 0, 10, 1);
    const auto of_a = [](const Vector& p, Eigen::Ref<Vector> values, Matrix* derivatives) -> Status {
      values.setConstant(p[0]);
      if (derivatives != nullptr) derivatives->col(0).setOnes();
      return {};
    };
    const auto of_both = [](const Vector& p, Eigen::Ref<Vector> values, Matrix* derivatives) -> Status {
      values.setConstant(p[0] + p[1]);
      if (derivatives != nullptr) derivatives->setOnes();
      return {};
    };
    AddBlock("first", {2, 2.1, 1.9, 2}, {0}, of_a);
    AddBlock("second", {7, 7.1, 6.9, 7}, {0, 1}, of_both);
  }
  [[nodiscard]] const std::vector<FitStep>& steps() const override { return steps_; }
  std::vector<FitStep> steps_{{"step 1 (a)", {0}, {0}}, {"step 2 (b)", {1}, {1}}};
};

TEST(Stepwise, EachStepHoldsWhatWasFoundBefore) {
  const Sum problem;
  const auto fit = IdentifyStepwise(problem, {}, {});
  ASSERT_TRUE(fit) << fit.error().message;
  EXPECT_NEAR(fit->parameters[0], 2, 1e-6);
  EXPECT_NEAR(fit->parameters[1], 5, 1e-6);
  ASSERT_EQ(fit->setup.free.size(), 1U) << "the last step's";
  EXPECT_EQ(fit->setup.free[0], 1);
  ASSERT_EQ(fit->steps.size(), 1U);
  EXPECT_EQ(fit->steps[0].name, "step 1 (a)");
  ASSERT_EQ(fit->steps[0].uncertainty.parameters.size(), 1U);
  EXPECT_NEAR(fit->steps[0].uncertainty.parameters[0].value, 2, 1e-6);
  ASSERT_FALSE(fit->warnings.empty());
  EXPECT_EQ(fit->warnings.back().kind, WarningKind::kHeldFromSteps);
  EXPECT_THAT(fit->warnings.back().names, testing::ElementsAre("a"));
  EXPECT_EQ(fit->prediction.quality.size(), 2U) << "of everything that was measured";
}

// b is the mean of the second trial less a, whose variance adds to that of the mean.
TEST(Stepwise, ErrorsOfHeldValuesAreCarried) {
  const Sum problem;
  const auto fit = IdentifyStepwise(problem, {}, {});
  ASSERT_TRUE(fit) << fit.error().message;
  const ParameterVerdict& a = fit->steps[0].uncertainty.parameters[0];
  const ParameterVerdict& b = fit->uncertainty.parameters[0];
  Sum alone;
  alone.steps_ = {{"step 1 (b)", {1}, {1}}};
  const auto known = IdentifyStepwise(alone, {}, {});
  ASSERT_TRUE(known) << known.error().message;
  const ParameterVerdict& b_alone = known->uncertainty.parameters[0];
  EXPECT_NEAR(b.std_error_robust,
              std::hypot(b_alone.std_error_robust, std::max(a.std_error, a.std_error_robust)),
              1e-6 * b.std_error_robust);
  EXPECT_GT(b.ci95_upper - b.ci95_lower, 1.15 * (b_alone.ci95_upper - b_alone.ci95_lower));
}

// The first step fits only its own trial: where trials disagree, the result depends on the order.
TEST(Stepwise, IsNotTheFitOfEverything) {
  Sum problem;
  problem.steps_ = {{"step 1 (b)", {1}, {1}}, {"step 2 (a)", {0}, {0}}};
  const auto fit = IdentifyStepwise(problem, {}, {});
  ASSERT_TRUE(fit) << fit.error().message;
  EXPECT_NEAR(fit->parameters[1], 6, 1e-6) << "with a at its start";
  EXPECT_NEAR(fit->parameters[0], 2, 1e-6);
}

TEST(Stepwise, ImpossibleRequestsAreErrors) {
  Sum problem;
  FitRequest request;
  request.fix = {{"a", 3}};
  EXPECT_EQ(ErrorOf(IdentifyStepwise(problem, request, {})), "step 1 (a): nothing is left to fit");
  request.fix = {{"b", 3}};
  IdentificationOptions options;
  bool evaluated = false;
  options.evaluator.progress = [&](const auto&...) { evaluated = true; };
  EXPECT_EQ(ErrorOf(IdentifyStepwise(problem, request, options)), "step 2 (b): nothing is left to fit");
  EXPECT_FALSE(evaluated) << "known before the first step is fitted";
  request = {};
  request.release = {"drift"};
  EXPECT_THAT(ErrorOf(IdentifyStepwise(problem, request, {})),
              HasSubstr("effect 'drift': a step frees base"));
  problem.steps_.clear();
  EXPECT_EQ(ErrorOf(IdentifyStepwise(problem, {}, {})), "the settings of this problem list no steps");
}

}  // namespace
}  // namespace sinew
