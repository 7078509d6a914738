// Priors that are there for a search only.
#include "identify/solvers/regularised_start.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/identify/support/random_walk.h"

namespace sinew {
namespace {

// A speed, a stiffness on a logarithmic scale, and a walk.
struct Shared {
  Shared() {
    problem.Add("speed", 0.1, 0.5, 0.33);
    (void)AddRandomWalk(problem, "t", 1, 3);
    Parameter stiffness;
    stiffness.name = "stiffness";
    stiffness.unit = "1";
    stiffness.lower = 1;
    stiffness.upper = 1e6;
    stiffness.start = 100;
    stiffness.scale = Scale::kLog;
    problem.Add(std::move(stiffness));
    setup = MakeFitSetup(problem, {}).value();
  }
  FunctionProblem problem;
  FitSetup setup;
};

TEST(RegularisedStart, OnlyParametersWithoutAPriorGetOne) {
  const Shared shared;
  const FitSetup regularised = solvers::Regularised(shared.setup, shared.setup.rest);
  const std::size_t last = shared.setup.parameters.size() - 1;
  ASSERT_TRUE(regularised.parameters[0].prior);
  EXPECT_EQ(regularised.parameters[0].prior->mean, 0.33);
  EXPECT_EQ(regularised.parameters[0].prior->standard_deviation, 0.5 * 0.33);
  ASSERT_TRUE(regularised.parameters[last].prior);
  EXPECT_EQ(regularised.parameters[last].prior->mean, std::log(100.0));
  EXPECT_EQ(regularised.parameters[last].prior->standard_deviation, 1);
  EXPECT_EQ(regularised.parameters[1].prior->standard_deviation, 1) << "a step of the walk keeps its own";
}

TEST(RegularisedStart, DrawnStartsStayInTheBoundsAndLeaveNuisanceValuesAlone) {
  const Shared shared;
  const Eigen::Index last = shared.setup.rest.size() - 1;
  Random random(1);
  for (int draw = 0; draw < 200; ++draw) {
    const Vector drawn = solvers::DrawnStart(shared.setup, shared.setup.rest, random);
    EXPECT_GE(drawn[0], 0.1);
    EXPECT_LE(drawn[0], 0.5);
    EXPECT_NE(drawn[0], 0.33);
    EXPECT_GE(drawn[last], 1);
    EXPECT_LE(drawn[last], 1e6);
    EXPECT_EQ(drawn.segment(1, last - 1), shared.setup.rest.segment(1, last - 1));
  }
}

TEST(RegularisedStart, IsTheSameWithAnyNumberOfThreadsAndEndsWhenItIsStopped) {
  const Shared shared;
  const LeastSquares fit(shared.problem, shared.setup);
  const Evaluator parent(fit, {});
  const Vector one = solvers::RegularisedStart(parent, shared.setup.rest, {{}, 1e-6, 1, 1});
  EXPECT_EQ(one, solvers::RegularisedStart(parent, shared.setup.rest, {{}, 1e-6, 1, 2}));
  auto workspace = fit.NewWorkspace();
  EXPECT_LT(*fit.Cost(one, workspace), 0.1 * *fit.Cost(fit.Start(), workspace));

  const std::atomic<bool> interrupt{true};
  Evaluator::Options options;
  options.interrupt = &interrupt;
  const Evaluator stopped(fit, std::move(options));
  EXPECT_EQ(solvers::RegularisedStart(stopped, shared.setup.rest, {{}, 1e-6, 1, 1}).size(), one.size());
}

}  // namespace
}  // namespace sinew
