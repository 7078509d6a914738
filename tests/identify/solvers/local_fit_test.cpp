#include "identify/solvers/local_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <tuple>

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

/// y = x^2 in two trials of two samples each; counts its predictions.
class Counted : public FunctionProblem {
 public:
  Counted() {
    Add("x", 0, 10, 7.3);
    for (const char* trial : {"one", "two"}) {
      AddBlock(trial, {3.9, 4.2}, {0},
               [this](const Vector& p, Eigen::Ref<Vector> values, Matrix* derivatives) {
                 ++predictions;
                 values.setConstant(p[0] * p[0]);
                 if (derivatives != nullptr) derivatives->setConstant(2 * p[0]);
                 return Status();
               });
    }
  }
  mutable int predictions = 0;
};

TEST(LocalFitTest, WhatIsInTheRecordIsNotFittedAgain) {
  const Counted problem;
  FitRecord record;
  int kept = 0;
  record.after_keep = [&] { ++kept; };
  FitSetup setup = MakeFitSetup(problem, {}).value();
  const auto fitted = [](const Problem& of, const FitSetup& with, double start, double tolerance) {
    const LeastSquares least_squares(of, with);
    solvers::LocalFit fit(least_squares);
    const auto outcome = fit.Minimize(Vector::Constant(1, start), -1, {0, tolerance}, 60);
    return std::tuple(outcome.x[0], outcome.cost, outcome.converged, outcome.failure, fit.evaluations(),
                      fit.penalty());
  };
  const auto alone = fitted(problem, setup, 0.7, 1e-9);
  setup.record = &record;
  EXPECT_EQ(fitted(problem, setup, 0.7, 1e-9), alone);
  EXPECT_EQ(kept, 1);
  problem.predictions = 0;
  EXPECT_EQ(fitted(problem, setup, 0.7, 1e-9), alone);
  EXPECT_EQ(problem.predictions, 0);
  EXPECT_EQ(kept, 1);

  // Whatever else is asked is fitted.
  fitted(problem, setup, 0.6, 1e-9);
  fitted(problem, setup, 0.7, 1e-8);
  const RoleView one_trial(problem, [](const Block& block) {
    return block.trial == "one" ? BlockRole::kTrain : BlockRole::kValidate;
  });
  fitted(one_trial, setup, 0.7, 1e-9);
  const EditedView weighted(problem, [](Block& block) { block.weight = 2; });
  fitted(weighted, setup, 0.7, 1e-9);
  const EditedView measured(problem, [](Block& block) { block.measured[1] = 4.3; });
  fitted(measured, setup, 0.7, 1e-9);
  FitSetup wider = setup;
  wider.parameters[0].upper = 11;
  fitted(problem, wider, 0.7, 1e-9);
  EXPECT_EQ(kept, 7);
}

/// y = amplitude sin(rate t + phase) + slope t over less than a turn: what is left is the same along a curved
/// valley, along which the four values replace each other.
class PartOfASine : public FunctionProblem {
 public:
  PartOfASine() {
    Add("amplitude", 0, 10, 8);
    Add("rate", 0.3, 5.3, 3.3);
    Add("phase", -3, 3, 0.6);
    Add("slope", -5, 5, 0);
    constexpr int kSamples = 60;
    std::vector<double> measured;
    for (int i = 0; i < kSamples; ++i) measured.push_back(std::sin(1.2 * Time(i) + 0.3) + 0.4 * Time(i));
    AddBlock("one", measured, {0, 1, 2, 3},
             [](const Vector& p, Eigen::Ref<Vector> values, Matrix* derivatives) {
               for (int i = 0; i < kSamples; ++i) {
                 const double sine = std::sin(p[1] * Time(i) + p[2]);
                 const double change = p[0] * std::cos(p[1] * Time(i) + p[2]);
                 values[i] = p[0] * sine + p[3] * Time(i);
                 if (derivatives != nullptr) derivatives->row(i) << sine, change * Time(i), change, Time(i);
               }
               return Status();
             });
  }

 private:
  static double Time(int i) { return i / 59.0; }
};

// A straight step of the damped Gauss-Newton method leaves such a valley unless it is short.
TEST(LocalFitTest, FollowsACurvedValley) {
  const PartOfASine problem;
  const Fit prepared(problem);
  solvers::LocalFit fit(prepared.least_squares);
  const auto outcome = fit.Minimize(prepared.least_squares.Start(), -1, {1e-14, 0}, 80);
  EXPECT_TRUE(outcome.converged);
  const Vector found = prepared.least_squares.Parameters(outcome.x);
  EXPECT_NEAR(found[0], 1, 1e-3);
  EXPECT_NEAR(found[1], 1.2, 1e-3);
  EXPECT_NEAR(found[2], 0.3, 1e-3);
  EXPECT_NEAR(found[3], 0.4, 1e-3);

  FitSetup setup = prepared.setup;
  setup.straight_steps = true;
  const LeastSquares straight(problem, setup);
  solvers::LocalFit by_straight_steps(straight);
  const auto stopped = by_straight_steps.Minimize(straight.Start(), -1, {1e-14, 0}, 80);
  EXPECT_FALSE(stopped.converged);
  EXPECT_GT(stopped.cost, 100 * outcome.cost);
}

}  // namespace
}  // namespace sinew
