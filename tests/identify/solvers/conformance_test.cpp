// Properties of every solver in the registry, and of a chain.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <ostream>

#include "identify/solvers/solver.h"
#include "tests/identify/support/classic_problems.h"

namespace sinew {

void PrintTo(const SolverEntry& entry, std::ostream* out) {
  *out << entry.name;
}

namespace {

constexpr long kBudget = 600;

struct Outcome {
  SolverResult result;
  std::vector<TraceEntry> trace;
};

class Conformance : public testing::TestWithParam<SolverEntry> {
 protected:
  static std::unique_ptr<Solver> Make(std::uint64_t seed = 7) {
    SolverOptions options;
    options.seed = seed;
    options.starts = 4;
    return MakeSolver(GetParam().name, options).value();
  }

  static Outcome Solve(const LeastSquares& problem, Evaluator::Options options) {
    Evaluator evaluator(problem, std::move(options));
    Outcome run;
    run.result = Make()->Solve(evaluator, problem.Start());
    run.trace = evaluator.trace();
    return run;
  }

  static Outcome Solve(const LeastSquares& problem, long budget = kBudget) {
    Evaluator::Options options;
    options.budget.max_evaluations = budget;
    return Solve(problem, options);
  }
};

double CostAtStart(const LeastSquares& problem) {
  LeastSquares::Workspace workspace = problem.NewWorkspace();
  return problem.Cost(problem.Start(), workspace).value();
}

bool SameTrace(const std::vector<TraceEntry>& a, const std::vector<TraceEntry>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const TraceEntry& one, const TraceEntry& other) {
                      return one.x == other.x && one.cost == other.cost;
                    });
}

TEST_P(Conformance, ImprovesWithinTheBoxAndTheBudget) {
  FunctionProblem problem;
  MakeRosenbrock(problem);
  const Fit fit(problem);
  const Outcome run = Solve(fit.least_squares);
  EXPECT_LT(run.result.cost, CostAtStart(fit.least_squares));
  EXPECT_LE(static_cast<long>(run.trace.size()), kBudget);
  EXPECT_EQ(run.trace.front().x, fit.least_squares.Start());
  for (const TraceEntry& entry : run.trace) {
    EXPECT_GE(entry.x.minCoeff(), 0);
    EXPECT_LE(entry.x.maxCoeff(), 1);
    EXPECT_GE(entry.cost, run.result.cost);
  }
  EXPECT_FALSE(run.result.stop.test.empty());
}

TEST_P(Conformance, SameSeedSameSearchToTheLastBit) {
  FunctionProblem problem;
  Judge::MakeProblem(problem);
  const Fit fit(problem);
  const Outcome first = Solve(fit.least_squares);
  const Outcome second = Solve(fit.least_squares);
  EXPECT_EQ(first.result.x, second.result.x);
  EXPECT_EQ(first.result.cost, second.result.cost);
  EXPECT_EQ(first.result.stop.test, second.result.stop.test);
  EXPECT_TRUE(SameTrace(first.trace, second.trace));
}

TEST_P(Conformance, SmallBudgetsAreKept) {
  FunctionProblem problem;
  MakeRosenbrock(problem);
  const Fit fit(problem);
  for (const long budget : {1, 2, 3, 7, 50}) {
    const Outcome run = Solve(fit.least_squares, budget);
    EXPECT_LE(static_cast<long>(run.trace.size()), budget);
    EXPECT_TRUE(run.result.stop.usable());
    EXPECT_LE(run.result.cost, CostAtStart(fit.least_squares));
  }
}

TEST_P(Conformance, NoBudgetNoAnswer) {
  FunctionProblem problem;
  MakeRosenbrock(problem);
  const Fit fit(problem);
  const Outcome run = Solve(fit.least_squares, 0);
  EXPECT_EQ(run.result.stop.kind, Termination::kNoPrediction);
  EXPECT_NE(run.result.stop.test.find("not even the start"), std::string::npos) << run.result.stop.test;
  EXPECT_EQ(run.result.x, fit.least_squares.Start());
  EXPECT_TRUE(std::isinf(run.result.cost));
}

TEST_P(Conformance, InterruptEndsItAtOnce) {
  FunctionProblem problem;
  MakeRosenbrock(problem);
  const Fit fit(problem);
  std::atomic<bool> interrupt = false;
  Evaluator::Options options;
  options.interrupt = &interrupt;
  options.progress = [&](const Progress& progress, const Evaluator&) {
    interrupt = progress.evaluations >= 5;
  };
  const Outcome run = Solve(fit.least_squares, options);
  EXPECT_EQ(run.result.stop.kind, Termination::kInterrupted) << run.result.stop.test;
  EXPECT_LE(run.result.cost, CostAtStart(fit.least_squares));
}

TEST_P(Conformance, ResumesToTheSameAnswer) {
  FunctionProblem problem;
  Judge::MakeProblem(problem);
  const Fit fit(problem);
  const Outcome whole = Solve(fit.least_squares);
  Evaluator::Options options;
  options.budget.max_evaluations = kBudget;
  options.replay = SearchRecord::OfAll(
      {whole.trace.begin(), whole.trace.begin() + static_cast<std::ptrdiff_t>(whole.trace.size() / 2)});
  const Outcome resumed = Solve(fit.least_squares, options);
  EXPECT_EQ(resumed.result.x, whole.result.x);
  EXPECT_EQ(resumed.result.cost, whole.result.cost);
  EXPECT_TRUE(SameTrace(resumed.trace, whole.trace));
}

TEST_P(Conformance, ReachesTheTargetAndStops) {
  FunctionProblem problem;
  MakeRosenbrock(problem);
  const Fit fit(problem);
  Evaluator::Options options;
  options.budget.max_evaluations = 20000;
  options.target_cost = 0.99 * CostAtStart(fit.least_squares);
  const Outcome run = Solve(fit.least_squares, options);
  EXPECT_EQ(run.result.stop.kind, Termination::kTarget) << run.result.stop.test;
  EXPECT_LE(run.result.cost, options.target_cost);
}

TEST_P(Conformance, GoesOnWhereSomePointsHaveNoPrediction) {
  FunctionProblem problem;
  MakeRosenbrock(problem, -1.3, 0.5);
  const Fit fit(problem);
  const Outcome run = Solve(fit.least_squares);
  EXPECT_LT(run.result.cost, CostAtStart(fit.least_squares)) << run.result.stop.test;
  EXPECT_LE(fit.least_squares.Parameters(run.result.x)[0], 0.5);
}

// Half of a squared distance, curved, with its minimum 0 at (5.5, 4), in the box [0, 10]^2.
class PartlyImpossible final : public FunctionProblem {
 public:
  explicit PartlyImpossible(const std::function<bool(double, double)>& fails) {
    Add("a", 0, 10, 1);
    Add("b", 0, 10, 2);
    AddBlock("t", {0, 0, 0}, {0, 1}, [fails](const Vector& p, auto values, Matrix* derivatives) -> Status {
      if (fails(p[0], p[1])) return Fail("no balance at a = {}, b = {}", p[0], p[1]);
      values << p[0] - 5.5, p[1] - 4, 0.05 * (p[0] * p[1] - 22);
      if (derivatives != nullptr) *derivatives << 1, 0, 0, 1, 0.05 * p[1], 0.05 * p[0];
      return {};
    });
  }
};

// Predictions fail on 40 % of the box, beside the minimum, in stripes or around it: whatever says that it
// converged has found the minimum.
TEST_P(Conformance, WhereMuchOfTheBoxHasNoPredictionItFindsTheMinimumOrSaysThatItDidNot) {
  const std::vector<std::pair<const char*, std::function<bool(double, double)>>> regions{
      {"half", [](double a, double) { return a > 6; }},
      {"stripes", [](double a, double b) { return std::fmod(a + b, 1) > 0.6 && std::abs(a - 5.5) > 0.5; }},
      {"corner", [](double a, double b) { return a + b > 10.95; }},
      {"disc", [](double a, double b) { return std::hypot(a - 9, b - 7) < 4.4; }}};
  for (const auto& [name, fails] : regions) {
    const PartlyImpossible problem(fails);
    const Fit fit(problem);
    const Outcome run = Solve(fit.least_squares, 3000);
    const double share = run.result.cost / CostAtStart(fit.least_squares);
    EXPECT_TRUE(run.result.stop.usable()) << name;
    EXPECT_TRUE(share < 1e-3 || !run.result.stop.converged())
        << name << ": " << share << " of the cost at the start, and: " << run.result.stop.test;
  }
}

TEST_P(Conformance, StartWithoutPrediction) {
  FunctionProblem problem;
  MakeRosenbrock(problem, 0);
  const Fit fit(problem);
  const Outcome run = Solve(fit.least_squares);
  if (GetParam().global) {
    EXPECT_TRUE(run.result.stop.usable());
    EXPECT_TRUE(std::isfinite(run.result.cost));
  } else {
    EXPECT_EQ(run.result.stop.kind, Termination::kNoPrediction);
    EXPECT_NE(run.result.stop.test.find("is out of reach"), std::string::npos) << run.result.stop.test;
  }
}

TEST_P(Conformance, NoPredictionAnywhere) {
  FunctionProblem problem;
  MakeRosenbrock(problem, 1e9);
  const Fit fit(problem);
  const Outcome run = Solve(fit.least_squares);
  EXPECT_EQ(run.result.stop.kind, Termination::kNoPrediction);
  EXPECT_NE(run.result.stop.test.find("is out of reach"), std::string::npos) << run.result.stop.test;
}

TEST_P(Conformance, NothingFree) {
  FunctionProblem problem;
  MakeRosenbrock(problem);
  FitRequest request;
  request.fix = {{"x1", 0.5}, {"x2", 0.5}};
  const Fit fit(problem, request);
  const Outcome run = Solve(fit.least_squares);
  EXPECT_EQ(run.result.stop.kind, Termination::kNothingFree);
  EXPECT_EQ(run.trace.size(), 1u);
  EXPECT_DOUBLE_EQ(run.result.cost, 0.5 * (2.5 * 2.5 + 0.5 * 0.5));
}

TEST_P(Conformance, OneVariable) {
  FunctionProblem problem;
  MakeRosenbrock(problem);
  FitRequest request;
  request.fix = {{"x2", 4}};
  const Fit fit(problem, request);
  const Outcome run = Solve(fit.least_squares);
  EXPECT_TRUE(run.result.stop.usable());
  EXPECT_LE(run.result.cost, CostAtStart(fit.least_squares));
}

// Minimum of Rosenbrock's cost on the line x1 + x2 = 1, by bisection of its derivative there.
double ConstrainedMinimum() {
  const auto cost = [](double x) { return 0.5 * (100 * std::pow(1 - x - x * x, 2) + std::pow(1 - x, 2)); };
  const auto slope = [](double x) { return -100 * (1 - x - x * x) * (1 + 2 * x) - (1 - x); };
  double low = 0.3;
  double high = 1;
  for (int i = 0; i < 100; ++i) (slope((low + high) / 2) < 0 ? low : high) = (low + high) / 2;
  return cost(low);
}

void AddConstraint(FunctionProblem& problem, double most) {
  Constraint constraint;
  constraint.name = "sum";
  constraint.coefficients = Vector::Ones(2);
  constraint.offset = -most;
  problem.Add(constraint);
}

TEST_P(Conformance, ConstraintsAreHonoured) {
  FunctionProblem problem;
  MakeRosenbrock(problem);
  AddConstraint(problem, 1);
  const Fit fit(problem);
  const Outcome run = Solve(fit.least_squares, 5000);
  // 1e-8: the evaluator's 1e-9 of the terms of the constraint, which are about 1.
  EXPECT_LE(fit.least_squares.Parameters(run.result.x).sum(), 1 + 1e-8);
  EXPECT_LT(run.result.cost, CostAtStart(fit.least_squares));
  // Searches without derivatives that rank points at random around the edge come within a few per cent.
  const double allowed = GetParam().global ? 0.1 : 1e-4;
  if (GetParam().constraints) {
    EXPECT_NEAR(run.result.cost, ConstrainedMinimum(), allowed) << run.result.stop.test;
  }
}

TEST_P(Conformance, InfeasibleStartIsLeftOrNamed) {
  FunctionProblem problem;
  MakeRosenbrock(problem);
  AddConstraint(problem, -1);  // the start has -0.2
  const Fit fit(problem);
  const Outcome run = Solve(fit.least_squares, 5000);
  if (run.result.stop.usable()) {
    EXPECT_LE(fit.least_squares.Parameters(run.result.x).sum(), -1 + 1e-8);
  } else {
    EXPECT_FALSE(GetParam().global || GetParam().constraints) << run.result.stop.test;
    EXPECT_EQ(run.result.stop.kind, Termination::kInfeasible);
  }
}

TEST_P(Conformance, ZeroResidualsEverywhere) {
  FunctionProblem problem;
  problem.Add("x", 0, 1, 0.3).Add("y", 0, 1, 0.3);
  problem.AddBlock("t", {0}, {0, 1}, [](const Vector&, Eigen::Ref<Vector> values, Matrix*) -> Status {
    values.setZero();
    return {};
  });
  const Fit fit(problem);
  const Outcome run = Solve(fit.least_squares);
  EXPECT_TRUE(run.result.stop.usable());
  EXPECT_EQ(run.result.cost, 0);
}

std::vector<SolverEntry> RegistryAndChain() {
  std::vector<SolverEntry> entries = SolverRegistry();
  entries.push_back({"sa+ceres", true, true, false, ""});
  entries.push_back({"cmaes+nlopt:LN_BOBYQA", true, false, false, ""});
  return entries;
}

INSTANTIATE_TEST_SUITE_P(Registry, Conformance, testing::ValuesIn(RegistryAndChain()), [](const auto& each) {
  std::string name = each.param.name;
  std::replace_if(
      name.begin(), name.end(), [](unsigned char c) { return std::isalnum(c) == 0; }, '_');
  return name;
});

}  // namespace
}  // namespace sinew
