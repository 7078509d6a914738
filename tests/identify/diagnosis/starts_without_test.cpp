// Where refits start that lack one cause.
#include "identify/diagnosis/select/starts_without.h"

#include <gtest/gtest.h>

#include "tests/identify/support/function_problem.h"

namespace sinew::diagnosis {
namespace {

/// y = base + (a + b) t + c t^2 at four times, measured with base 1, a + b = 3 and c = 0.5.
class TwoSlopes : public FunctionProblem {
 public:
  explicit TwoSlopes(double b_upper) {
    Add("base", -5, 5, 1);
    Add("a", -5, 5, 1.2);
    Add("b", -5, b_upper, 1.8);
    Add("c", -5, 5, 0.5);
    AddBlock("one", {1, 4.5, 9, 14.5}, {0, 1, 2, 3},
             [](const Vector& p, Eigen::Ref<Vector> values, Matrix* derivatives) {
               for (int i = 0; i < 4; ++i) {
                 const double t = i;
                 values[i] = p[0] + (p[1] + p[2]) * t + p[3] * t * t;
                 if (derivatives != nullptr) derivatives->row(i) << 1, t, t, t * t;
               }
               return Status();
             });
  }
};

TEST(StartsWithout, AnEffectThatDoesTheSameTakesOver) {
  const TwoSlopes problem(5);
  const Fit prepared(problem);
  const LeastSquares& fit = prepared.least_squares;
  const Vector nulls = Vector::Zero(4);
  const auto starts = StartsWithout(fit, fit.Start(), {{1}, {2}}, nulls);
  ASSERT_TRUE(starts);
  ASSERT_EQ(starts->size(), 2u);
  // Without a, b is the slope; without b, a.
  EXPECT_EQ((*starts)[0][1], 0);
  EXPECT_NEAR((*starts)[0][2], 3, 1e-6);
  EXPECT_EQ((*starts)[1][2], 0);
  EXPECT_NEAR((*starts)[1][1], 3, 1e-6);
  EXPECT_NEAR((*starts)[1][0], 1, 1e-6);
  EXPECT_NEAR((*starts)[1][3], 0.5, 1e-6);
}

TEST(StartsWithout, WithinTheBounds) {
  const TwoSlopes problem(2);
  const Fit prepared(problem);
  const LeastSquares& fit = prepared.least_squares;
  const auto starts = StartsWithout(fit, fit.Start(), {{1}}, Vector::Zero(4));
  ASSERT_TRUE(starts);
  EXPECT_EQ((*starts)[0][2], 2);
  // The others take over what b cannot: the fit of base + 2 t + c t^2 to the data.
  const Vector& start = (*starts)[0];
  const double sum = (problem.layout()[0].measured[0] - start[0]) +
                     (problem.layout()[0].measured[1] - start[0] - 2 - start[3]) +
                     (problem.layout()[0].measured[2] - start[0] - 4 - 4 * start[3]) +
                     (problem.layout()[0].measured[3] - start[0] - 6 - 9 * start[3]);
  EXPECT_NEAR(sum, 0, 1e-5);
}

TEST(StartsWithout, WithoutAPredictionThereIsNoStart) {
  FunctionProblem problem;
  problem.Add("a", 0, 1, 0.5);
  problem.AddBlock("one", {1}, {0}, [](const Vector&, Eigen::Ref<Vector>, Matrix*) -> Status {
    return Fail("no prediction here");
  });
  const Fit prepared(problem);
  const auto starts =
      StartsWithout(prepared.least_squares, prepared.least_squares.Start(), {{0}}, Vector::Zero(1));
  ASSERT_FALSE(starts);
  EXPECT_EQ(starts.error().message, "no prediction here");
}

}  // namespace
}  // namespace sinew::diagnosis
