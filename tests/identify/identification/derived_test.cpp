#include "identify/identification/derived.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/identify/support/toy_problem.h"

namespace sinew {
namespace {

// Two parameters, x = 2 and y = 0.09, and one quantity of them.
class DerivedProblem final : public Problem {
 public:
  explicit DerivedProblem(std::function<double(double, double)> value) : value_(std::move(value)) {}
  [[nodiscard]] const std::vector<Parameter>& parameters() const override { return parameters_; }
  [[nodiscard]] const Layout& layout() const override { return layout_; }
  Status Predict(const Query& /*query*/, Workspace& /*workspace*/,
                 Prediction& /*prediction*/) const override {
    return {};
  }
  [[nodiscard]] std::vector<DerivedQuantity> DerivedQuantities() const override {
    return {{"q", "1", "a test", {0, 1}, [this](const Vector& p) { return value_(p[0], p[1]); }}};
  }

 private:
  std::function<double(double, double)> value_;
  std::vector<Parameter> parameters_{toy::MakeParameter("x", 0, 10, 2), toy::MakeParameter("y", 0, 1, 0.09)};
  Layout layout_;
};

struct Given {
  double x_half = 0.3;
  double y_lower = 0.05;
  double y_upper = 0.13;
  double correlation = 0.5;
  std::vector<int> free{0, 1};
};

std::vector<DerivedResult> Derive(const std::function<double(double, double)>& value,
                                  const Given& given = {}) {
  const DerivedProblem problem(value);
  FitSetup setup;
  setup.parameters = problem.parameters();
  setup.free = given.free;
  Vector at(2);
  at << 2, 0.09;
  Uncertainty uncertainty;
  for (const int index : given.free) {
    ParameterVerdict v;
    v.parameter = index;
    v.value = at[index];
    v.ci95_lower = index == 0 ? at[0] - given.x_half : given.y_lower;
    v.ci95_upper = index == 0 ? at[0] + given.x_half : given.y_upper;
    v.interval = IntervalKind::kProfile;
    uncertainty.parameters.push_back(v);
  }
  uncertainty.correlation = Matrix::Identity(2, 2);
  uncertainty.correlation(0, 1) = uncertainty.correlation(1, 0) = given.correlation;
  return DeriveResults(problem, setup, at, uncertainty);
}

TEST(Derived, OfALinearFunctionItIsErrorPropagation) {
  for (const double correlation : {-0.9, 0.0, 0.5}) {
    Given given;
    given.correlation = correlation;
    const auto found = Derive([](double x, double y) { return 3 * x - 10 * y; }, given);
    ASSERT_EQ(found.size(), 1U);
    EXPECT_NEAR(found[0].value, 5.1, 1e-12);
    ASSERT_TRUE(found[0].interval);
    const double a = 3 * 0.3;
    const double b = -10 * 0.04;
    const double half = std::sqrt(a * a + b * b + 2 * correlation * a * b);
    EXPECT_NEAR(found[0].ci95_lower, 5.1 - half, 1e-12) << correlation;
    EXPECT_NEAR(found[0].ci95_upper, 5.1 + half, 1e-12) << correlation;
    EXPECT_EQ(found[0].from, (std::vector<std::string>{"x", "y"}));
  }
}

// The distance of two poles is a root: of an interval that begins at 0 it has a finite one.
TEST(Derived, ARootOfAnIntervalThatBeginsAtZero) {
  Given given;
  given.y_lower = 0;
  given.free = {1};
  const auto found = Derive([](double x, double y) { return x + std::sqrt(y); }, given);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NEAR(found[0].ci95_lower, 2, 1e-12) << "x is held, and counts as exact";
  EXPECT_NEAR(found[0].ci95_upper, 2 + std::sqrt(0.13), 1e-12);
  EXPECT_EQ(found[0].from, std::vector<std::string>{"y"});
}

TEST(Derived, NothingThatIsHeldAltogether) {
  Given given;
  given.free = {};
  EXPECT_TRUE(Derive([](double x, double y) { return x * y; }, given).empty());
}

TEST(Derived, AParameterOutsideItsIntervalGivesNone) {
  Given given;
  given.y_lower = 0.1;
  const auto found = Derive([](double x, double y) { return x * y; }, given);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_FALSE(found[0].interval);
  EXPECT_NEAR(found[0].value, 0.18, 1e-12);
}

}  // namespace
}  // namespace sinew
