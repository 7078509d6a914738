// Properties of single solvers beyond the conformance suite.
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <set>

#include "base/random.h"
#include "identify/solvers/ceres_solver.h"
#include "identify/solvers/multistart.h"
#include "identify/solvers/solver.h"
#include "tests/identify/support/classic_problems.h"

namespace sinew {
namespace {

SolverResult SolveWith(const std::string& name, const LeastSquares& problem, Evaluator& evaluator,
                       const SolverOptions& options = {}) {
  return MakeSolver(name, options).value()->Solve(evaluator, problem.Start());
}

// y = a exp(-b t) + offset of the trial; every trial has noise and an offset of its own.
void MakeTrialsWithOffsets(FunctionProblem& problem, bool sparse) {
  constexpr int kTrials = 5;
  constexpr int kSamples = 30;
  problem.Add("a", 0, 10, 1).Add("b", 0, 5, 1);
  Random random(3);
  for (int t = 0; t < kTrials; ++t) {
    const std::string trial = "trial" + std::to_string(t);
    Parameter offset;
    offset.name = "offset/" + trial;
    offset.unit = "1";
    offset.lower = -5;
    offset.upper = 5;
    offset.kind = ParameterKind::kNuisance;
    if (sparse) offset.trial = trial;
    problem.Add(offset);
  }
  for (int t = 0; t < kTrials; ++t) {
    std::vector<double> measured;
    for (int i = 0; i < kSamples; ++i) {
      measured.push_back(3 * std::exp(-0.7 * 0.1 * i) + 0.5 * t - 1 + 0.05 * random.Normal());
    }
    problem.AddBlock("trial" + std::to_string(t), measured, {0, 1, 2 + t},
                     [t](const Vector& p, Eigen::Ref<Vector> values, Matrix* derivatives) -> Status {
                       for (int i = 0; i < kSamples; ++i) {
                         const double decay = std::exp(-p[1] * 0.1 * i);
                         values[i] = p[0] * decay + p[2 + t];
                         if (derivatives == nullptr) continue;
                         (*derivatives)(i, 0) = decay;
                         (*derivatives)(i, 1) = -0.1 * i * p[0] * decay;
                         (*derivatives)(i, 2 + t) = 1;
                       }
                       return {};
                     });
  }
}

TEST(Ceres, SparseTrialsGiveTheDenseAnswer) {
  FunctionProblem dense_problem;
  FunctionProblem sparse_problem;
  MakeTrialsWithOffsets(dense_problem, false);
  MakeTrialsWithOffsets(sparse_problem, true);
  const Fit dense(dense_problem);
  const Fit sparse(sparse_problem);
  Evaluator dense_evaluator(dense.least_squares, {});
  Evaluator sparse_evaluator(sparse.least_squares, {});
  const SolverResult a = solvers::CeresSolver(1e-14).Solve(dense_evaluator, dense.least_squares.Start());
  const SolverResult b = solvers::CeresSolver(1e-14).Solve(sparse_evaluator, sparse.least_squares.Start());
  EXPECT_TRUE(a.stop.converged());
  EXPECT_TRUE(b.stop.converged());
  // Normal equations lose half of the digits of a condition of about 1e2, twice that with the square.
  EXPECT_LT((a.x - b.x).cwiseAbs().maxCoeff(), 1e-8);
  EXPECT_NEAR(a.cost, b.cost, 1e-12 * a.cost);
}

TEST(Ceres, PriorsAreResidualsToo) {
  FunctionProblem problem;
  Parameter x;
  x.name = "x";
  x.lower = -10;
  x.upper = 10;
  x.prior = GaussianPrior{2, 1};
  problem.Add(x);
  problem.AddBlock("t", {0}, {0},
                   [](const Vector& p, Eigen::Ref<Vector> values, Matrix* derivatives) -> Status {
                     values[0] = p[0];
                     if (derivatives != nullptr) (*derivatives)(0, 0) = 1;
                     return {};
                   });
  const Fit fit(problem);
  Evaluator evaluator(fit.least_squares, {});
  const SolverResult result = SolveWith("ceres", fit.least_squares, evaluator);
  // Equal weights: half way. A relative cost change of 1e-12 is a step of 1e-6 at most.
  EXPECT_NEAR(fit.least_squares.Parameters(result.x)[0], 1, 1e-6);
}

TEST(LocalSolvers, StopAtAnActiveBound) {
  FunctionProblem problem;
  MakeRosenbrock(problem);
  FitRequest request;
  request.bounds = {{"x1", {-5, 0.5}}};
  const Fit fit(problem, request);
  for (const char* name : {"ceres", "lm"}) {
    Evaluator evaluator(fit.least_squares, {});
    const SolverResult result = SolveWith(name, fit.least_squares, evaluator);
    const Vector found = fit.least_squares.Parameters(result.x);
    EXPECT_EQ(found[0], 0.5) << name;
    EXPECT_NEAR(found[1], 0.25, 1e-9) << name;
    EXPECT_TRUE(result.stop.converged()) << result.stop.test;
  }
}

TEST(Ceres, StatesTheFiguresOfItsTest) {
  FunctionProblem problem;
  Judge::MakeProblem(problem);
  const Fit fit(problem);
  Evaluator evaluator(fit.least_squares, {});
  const SolverResult result = SolveWith("ceres", fit.least_squares, evaluator);
  EXPECT_TRUE(result.stop.converged());
  EXPECT_NE(result.stop.test.find("<="), std::string::npos) << result.stop.test;
}

TEST(BasinHopping, LeavesALocalMinimumWhereLmStays) {
  FunctionProblem problem;
  problem.Add("x", 0, 1, 0.3);
  // Minima of a wave on a slope; the lowest is the last.
  problem.AddBlock("t", {0, 0}, {0},
                   [](const Vector& p, Eigen::Ref<Vector> values, Matrix* derivatives) -> Status {
                     constexpr double kWave = 40;
                     values << 2 - p[0], 0.3 * std::sin(kWave * p[0]);
                     if (derivatives != nullptr) *derivatives << -1, 0.3 * kWave * std::cos(kWave * p[0]);
                     return {};
                   });
  const Fit fit(problem);
  Evaluator local(fit.least_squares, {});
  Evaluator global(fit.least_squares, {});
  const double stuck = SolveWith("lm", fit.least_squares, local).cost;
  const SolverResult result = SolveWith("basin-hopping", fit.least_squares, global);
  double lowest = 1e9;
  for (int i = 0; i <= 100000; ++i) {
    const double x = i / 100000.0;
    lowest = std::min(lowest, 0.5 * ((2 - x) * (2 - x) + std::pow(0.3 * std::sin(40 * x), 2)));
  }
  EXPECT_GT(stuck, 1.2 * lowest);
  EXPECT_NEAR(result.cost, lowest, 1e-6);
  EXPECT_EQ(result.stop.kind, Termination::kStartsDone);
}

TEST(Ceres, NothingIsPrinted) {
  FunctionProblem problem;
  MakeRosenbrock(problem, -1.3, 0.5);
  const Fit fit(problem);
  for (const char* name : {"ceres", "lm", "basin-hopping", "restarts", "ipopt", "nlopt:GD_STOGO",
                           "nlopt:GN_AGS", "nlopt:LN_PRAXIS"}) {
    Evaluator::Options options;
    options.budget.max_evaluations = 300;
    Evaluator evaluator(fit.least_squares, options);
    testing::internal::CaptureStdout();
    testing::internal::CaptureStderr();
    SolveWith(name, fit.least_squares, evaluator);
    EXPECT_EQ(testing::internal::GetCapturedStdout(), "") << name;
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "") << name;
  }
}

TEST(LocalSolvers, RosenbrockToTheMinimum) {
  FunctionProblem problem;
  MakeRosenbrock(problem);
  const Fit fit(problem);
  for (const char* name :
       {"ceres", "ipopt", "ipopt-lbfgs", "nlopt:LN_BOBYQA", "nlopt:LD_LBFGS", "nlopt:LD_SLSQP", "cmaes",
        "multistart", "basin-hopping", "restarts", "starts", "lm", "sa+ceres"}) {
    Evaluator::Options options;
    options.budget.max_evaluations = 3000;
    Evaluator evaluator(fit.least_squares, options);
    const SolverResult result = SolveWith(name, fit.least_squares, evaluator);
    const Vector found = fit.least_squares.Parameters(result.x);
    // A cost of 1e-12 is a residual of 1e-6.
    EXPECT_LT(result.cost, 1e-12) << name << ": " << result.stop.test;
    EXPECT_NEAR(found[0], 1, 1e-5) << name;
    EXPECT_NEAR(found[1], 1, 1e-5) << name;
  }
}

TEST(Chain, EachLinkBeginsWhereTheLastEnded) {
  FunctionProblem problem;
  Judge::MakeProblem(problem);
  const Fit fit(problem);
  Evaluator::Options options;
  options.budget.max_evaluations = 1000;
  Evaluator evaluator(fit.least_squares, options);
  const SolverResult result = SolveWith("sa+ceres", fit.least_squares, evaluator);
  ASSERT_EQ(result.stages.size(), 2u);
  EXPECT_EQ(result.stages[0].solver, "sa");
  EXPECT_EQ(result.stages[0].evaluations, 800);  // four fifths of what the start left
  EXPECT_EQ(result.stages[0].stop.kind, Termination::kMaxEvaluations);
  EXPECT_EQ(result.stages[1].solver, "ceres");
  EXPECT_LE(result.stages[1].cost, result.stages[0].cost);
  EXPECT_EQ(result.cost, result.stages[1].cost);
  EXPECT_TRUE(result.stop.converged()) << result.stop.test;
  EXPECT_NEAR(2 * result.cost, Judge::kOptimum, 1e-6);  // published with seven decimals
}

TEST(MultiStart, FindsBothMinimaAndOrdersThem) {
  FunctionProblem problem;
  Judge::MakeProblem(problem);
  const Fit fit(problem);
  Evaluator evaluator(fit.least_squares, {});
  const SolverResult result = SolveWith("multistart", fit.least_squares, evaluator);
  EXPECT_EQ(result.stop.kind, Termination::kStartsDone) << result.stop.test;
  ASSERT_EQ(result.stages.size(), 20u);
  EXPECT_NEAR(2 * result.stages.front().cost, 16.0817307, 1e-6);
  EXPECT_GT(2 * result.stages.back().cost,
            20.4);  // the given start, which is stationary, or the local minimum
  for (std::size_t i = 1; i < result.stages.size(); ++i) {
    EXPECT_LE(result.stages[i - 1].cost, result.stages[i].cost);
  }
}

TEST(MultiStart, ThreadsDoNotChangeAnswerOrTrace) {
  FunctionProblem problem;
  Judge::MakeProblem(problem);
  const Fit fit(problem);
  for (const double target : {-1.0, 8.5}) {
    std::vector<std::vector<TraceEntry>> traces;
    std::vector<SolverResult> results;
    for (const int threads : {1, 2, 4}) {
      Evaluator::Options options;
      options.budget.max_evaluations = 400;
      options.target_cost = target;
      Evaluator evaluator(fit.least_squares, options);
      SolverOptions solver;
      solver.threads = threads;
      results.push_back(SolveWith("multistart", fit.least_squares, evaluator, solver));
      traces.push_back(evaluator.trace());
    }
    for (std::size_t i = 1; i < traces.size(); ++i) {
      EXPECT_EQ(results[i].x, results[0].x);
      EXPECT_EQ(results[i].stop.test, results[0].stop.test);
      ASSERT_EQ(traces[i].size(), traces[0].size());
      for (std::size_t k = 0; k < traces[0].size(); ++k) {
        EXPECT_EQ(traces[i][k].x, traces[0][k].x);
        EXPECT_EQ(traces[i][k].cost, traces[0][k].cost);
      }
    }
  }
}

TEST(MultiStart, ReportsWhenTheBudgetAllowsFewerStarts) {
  FunctionProblem problem;
  Judge::MakeProblem(problem);
  const Fit fit(problem);
  Evaluator::Options options;
  options.budget.max_evaluations = 101;
  Evaluator evaluator(fit.least_squares, options);
  const SolverResult result = SolveWith("multistart", fit.least_squares, evaluator);
  EXPECT_EQ(result.stages.size(), 5u);
  EXPECT_EQ(result.stop.kind, Termination::kStartsUnfinished);
  EXPECT_EQ(result.stop.test.substr(0, 17), "5 of 20 starts: 5") << result.stop.test;
}

// Starts that converge with less than their share leave a part of the budget.
TEST(MultiStart, DoesNotReportAUsedBudgetIfSomeIsLeft) {
  FunctionProblem problem;
  Judge::MakeProblem(problem);
  const Fit fit(problem);
  Evaluator::Options options;
  options.budget.max_evaluations = 400;
  Evaluator evaluator(fit.least_squares, options);
  const SolverResult result = SolveWith("multistart", fit.least_squares, evaluator);
  ASSERT_LT(evaluator.evaluations(), 400);
  EXPECT_EQ(result.stop.kind, Termination::kStartsUnfinished) << result.stop.test;
  EXPECT_FALSE(result.stop.converged());
  EXPECT_TRUE(result.stop.usable());
}

TEST(LatinHypercube, OnePointPerIntervalOfEveryVariable) {
  constexpr int kCount = 9;
  for (int k = 0; k < 3; ++k) {
    std::set<int> intervals;
    for (const Vector& x : solvers::LatinHypercube(kCount, 3, 5))
      intervals.insert(static_cast<int>(x[k] * kCount));
    EXPECT_EQ(intervals.size(), static_cast<std::size_t>(kCount));
  }
  EXPECT_NE(solvers::LatinHypercube(kCount, 3, 5)[0], solvers::LatinHypercube(kCount, 3, 6)[0]);
}

TEST(Nlopt, GlobalSearchWithoutBudgetEnds) {
  FunctionProblem problem;
  Judge::MakeProblem(problem);
  const Fit fit(problem);
  Evaluator evaluator(fit.least_squares, {});
  const SolverResult result = SolveWith("nlopt:GN_ESCH", fit.least_squares, evaluator);
  EXPECT_LE(evaluator.evaluations(), 20000);
  EXPECT_EQ(result.stop.kind, Termination::kMaxEvaluations);
  EXPECT_NE(result.stop.test.find("the most that this search is given"), std::string::npos)
      << result.stop.test;
}

TEST(Resume, RecordedEvaluationsAreNotPredictedAgain) {
  long predictions = 0;
  FunctionProblem problem;
  problem.Add("x", -1, 1, 0.5).Add("y", -1, 1, 0.5);
  problem.AddBlock("t", {0, 0}, {0, 1},
                   [&predictions](const Vector& p, Eigen::Ref<Vector> values, Matrix*) -> Status {
                     ++predictions;
                     values = p;
                     return {};
                   });
  const Fit fit(problem);
  constexpr long kEvaluations = 1000;
  constexpr long kInterruptedAt = 400;
  Evaluator::Options options;
  options.budget.max_evaluations = kEvaluations;
  Evaluator whole(fit.least_squares, options);
  const SolverResult expected = SolveWith("sa", fit.least_squares, whole);
  EXPECT_EQ(predictions, whole.evaluations());

  std::atomic<bool> interrupt = false;
  options.interrupt = &interrupt;
  options.progress = [&](const Progress& progress, const Evaluator&) {
    interrupt = progress.evaluations == kInterruptedAt;
  };
  Evaluator interrupted(fit.least_squares, options);
  EXPECT_EQ(SolveWith("sa", fit.least_squares, interrupted).stop.kind, Termination::kInterrupted);
  EXPECT_EQ(interrupted.evaluations(), kInterruptedAt);

  options.interrupt = nullptr;
  options.replay = interrupted.record();
  Evaluator resumed(fit.least_squares, options);
  predictions = 0;
  const SolverResult result = SolveWith("sa", fit.least_squares, resumed);
  EXPECT_EQ(predictions, whole.evaluations() - kInterruptedAt);
  EXPECT_EQ(result.x, expected.x);
  EXPECT_EQ(result.cost, expected.cost);
}

TEST(Resume, FinishedLocalSearchesAreNotDoneAgain) {
  std::atomic<long> predictions = 0;
  FunctionProblem problem;
  problem.Add("x", -1, 1, 0.5).Add("y", -1, 1, 0.5);
  problem.AddBlock("t", {0, 0}, {0, 1},
                   [&predictions](const Vector& p, Eigen::Ref<Vector> values, Matrix* jacobian) -> Status {
                     ++predictions;
                     if (p[0] < -0.9) return Fail("no prediction there");
                     values << std::sin(5 * p[0]) + p[1] * p[1], p[0] * p[0] - std::cos(4 * p[1]);
                     if (jacobian != nullptr)
                       *jacobian << 5 * std::cos(5 * p[0]), 2 * p[1], 2 * p[0], 4 * std::sin(4 * p[1]);
                     return {};
                   });
  const Fit fit(problem);
  for (const auto& [name, most_entries] :
       {std::pair("multistart", 0L), std::pair("restarts", 0L), std::pair("basin-hopping", 0L),
        std::pair("multistart", 16L), std::pair("restarts", 16L), std::pair("basin-hopping", 16L)}) {
    Evaluator::Options options;
    options.most_entries = most_entries;  // also of a record that does not have all points
    Evaluator whole(fit.least_squares, options);
    predictions = 0;
    const SolverResult expected = SolveWith(name, fit.least_squares, whole);
    const long of_whole = predictions;

    std::atomic<bool> interrupt = false;
    options.interrupt = &interrupt;
    options.progress = [&](const Progress& progress, const Evaluator&) {
      interrupt = progress.evaluations >= whole.evaluations() / 2;
    };
    Evaluator interrupted(fit.least_squares, options);
    SolveWith(name, fit.least_squares, interrupted);
    ASSERT_FALSE(interrupted.finished().empty()) << name;
    ASSERT_LT(interrupted.finished().size(), whole.finished().size()) << name;

    options.interrupt = nullptr;
    options.replay = interrupted.record();
    options.finished = interrupted.finished();
    Evaluator resumed(fit.least_squares, options);
    predictions = 0;
    const SolverResult result = SolveWith(name, fit.least_squares, resumed);
    EXPECT_LT(predictions, of_whole - whole.evaluations() / 4) << name;
    EXPECT_EQ(result.x, expected.x) << name;
    EXPECT_EQ(result.cost, expected.cost) << name;
    EXPECT_EQ(result.stop.test, expected.stop.test) << name;
    EXPECT_EQ(resumed.failures(), whole.failures()) << name;
    EXPECT_EQ(resumed.first_failure(), whole.first_failure()) << name;
    ASSERT_EQ(resumed.evaluations(), whole.evaluations()) << name;
    ASSERT_EQ(resumed.trace().size(), whole.trace().size()) << name;
    EXPECT_EQ(whole.record().thinned(), most_entries > 0) << name;
    for (std::size_t i = 0; i < whole.trace().size(); ++i) {
      EXPECT_EQ(resumed.trace()[i].cost, whole.trace()[i].cost) << name;
      EXPECT_EQ(resumed.trace()[i].x, whole.trace()[i].x) << name;
    }
  }
}

TEST(GlobalSolvers, GiveUpWhereNothingCanBePredicted) {
  FunctionProblem problem;
  MakeRosenbrock(problem, 1e9);
  const Fit fit(problem);
  for (const char* name : {"sa", "cmaes", "nlopt:GN_CRS2_LM"}) {
    Evaluator evaluator(fit.least_squares, {});
    const SolverResult result = SolveWith(name, fit.least_squares, evaluator);
    EXPECT_EQ(result.stop.kind, Termination::kNoPrediction) << name;
    EXPECT_LE(evaluator.evaluations(), 10001) << name;
  }
}

}  // namespace
}  // namespace sinew
