#include "identify/identification/identification.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <thread>
#include <vector>

#include "base/process_memory.h"
#include "tests/identify/support/error_of.h"
#include "tests/identify/support/function_problem.h"
#include "tests/identify/support/line_fit.h"

namespace sinew {
namespace {

using testing::HasSubstr;
using toy::LineProblem;
using toy::ToyProblem;
using toy::Values;

TEST(Identification, FitsALineWithItsUncertainty) {
  constexpr double kFourSigma =
      0.16;  // 4 x 0.1 x 2 / sqrt(30): chance of failure below 1e-4, the seed is fixed
  const ToyProblem problem = LineProblem();
  const Identification line = toy::IdentifyLine(problem);
  ASSERT_TRUE(line.result.stop.converged()) << line.result.stop.test;
  EXPECT_NEAR(line.parameters[0], 1, kFourSigma);
  EXPECT_NEAR(line.parameters[1], 3, kFourSigma);
  ASSERT_EQ(line.uncertainty.parameters.size(), 2U);
  EXPECT_EQ(line.uncertainty.parameters[1].verdict, Verdict::kIdentifiable);
  ASSERT_EQ(line.prediction.quality.size(), 2U);
  EXPECT_EQ(line.prediction.values.size(), 3U);
  EXPECT_EQ(line.pooled_fit.size(), line.prediction.pooled.size());
  EXPECT_FALSE(line.record.trace().empty());
  EXPECT_THAT(line.warnings, testing::IsEmpty());
}

TEST(Identification, NothingFreeIsAPrediction) {
  const ToyProblem problem = LineProblem();
  FitRequest request;
  request.fix = {{"offset", 1}, {"slope", 3}};
  const auto line = Identify(problem, MakeFitSetup(problem, request).value(), {});
  ASSERT_TRUE(line) << line.error().message;
  EXPECT_EQ(line->result.stop.kind, Termination::kNothingFree);
  EXPECT_EQ(line->parameters, Values({1, 3}));
  EXPECT_TRUE(line->uncertainty.parameters.empty());
  EXPECT_EQ(line->prediction.values[0][29], 7);
}

TEST(Identification, CanBeStoppedOnceTheSearchHasEnded) {
  const ToyProblem problem = LineProblem();
  std::atomic<bool> stop{false};
  IdentificationOptions options;
  options.evaluator.interrupt = &stop;
  options.after_search = [&](const SolverResult& found) { stop = found.stop.converged(); };
  const Identification line = toy::IdentifyLine(problem, options);
  EXPECT_TRUE(line.interrupted);
  EXPECT_TRUE(line.result.stop.converged()) << line.result.stop.test;
  for (const auto& parameter : line.uncertainty.parameters)
    EXPECT_EQ(parameter.interval, IntervalKind::kLinear);
}

TEST(Identification, AfterASearchThatUsedItsMemoryIntervalsAreLinear) {
  const ToyProblem problem = LineProblem();
  IdentificationOptions options;
  options.solver = "sa";
  constexpr double kRoom = 50e6;  // [bytes]
  options.evaluator.budget.max_memory = static_cast<double>(ResidentMemory()) + kRoom;
  std::vector<char> large;
  options.evaluator.progress = [&](const Progress& now, const Evaluator&) {
    if (now.evaluations != 10) return;
    large.assign(static_cast<std::size_t>(2 * kRoom), 1);
    std::this_thread::sleep_for(std::chrono::milliseconds(50));  // until memory is looked at again
  };
  const Identification line = toy::IdentifyLine(problem, options);
  EXPECT_EQ(line.result.stop.kind, Termination::kMaxMemory);
  EXPECT_GE(line.record.evaluations(), 10);
  ASSERT_EQ(line.uncertainty.parameters.size(), 2U);
  for (const auto& parameter : line.uncertainty.parameters)
    EXPECT_EQ(parameter.interval, IntervalKind::kLinear);
}

TEST(Identification, AnUnfinishedSearchIsAWarning) {
  const ToyProblem problem = LineProblem();
  IdentificationOptions options;
  options.solver = "sa";
  options.evaluator.budget.max_evaluations = 10;
  const Identification line = toy::IdentifyLine(problem, options);
  EXPECT_EQ(line.result.stop.kind, Termination::kMaxEvaluations);
  EXPECT_EQ(line.record.evaluations(), 10);
  ASSERT_FALSE(line.warnings.empty());
  EXPECT_EQ(line.warnings.front().kind, WarningKind::kNotConverged);
  EXPECT_EQ(line.warnings.front().message, line.result.stop.test);
}

// A point on a spiral: its distance from the origin has a minimum of 0.5 at a = 0.3, and one of 0 at a =
// 0.59, beyond a hill of 0.52; with 20 further residuals of size 1.
void MakeSpiral(FunctionProblem& problem) {
  problem.Add("a", 0, 1, 0.25);
  std::vector<double> measured{0, 0};
  for (int i = 0; i < 20; ++i) measured.push_back(i % 2 == 0 ? 1 : -1);
  problem.AddBlock("t", measured, {0},
                   [](const Vector& p, Eigen::Ref<Vector> values, Matrix* derivatives) -> Status {
                     const double d = p[0] - 0.3;
                     const double radius = 0.5 + 37 * d * d * (0.15 - d);
                     const double slope = 37 * d * (0.3 - 3 * d);
                     const double angle = 15 * d;
                     values.setZero();
                     values[0] = radius * std::cos(angle);
                     values[1] = radius * std::sin(angle);
                     if (derivatives != nullptr) {
                       derivatives->setZero();
                       (*derivatives)(0, 0) = slope * std::cos(angle) - 15 * values[1];
                       (*derivatives)(1, 0) = slope * std::sin(angle) + 15 * values[0];
                     }
                     return {};
                   });
}

TEST(Identification, ABetterPointMetOnTheWayToAnIntervalBecomesTheAnswer) {
  FunctionProblem problem;
  MakeSpiral(problem);
  IdentificationOptions options;
  options.solver = "ceres";
  options.profiles = false;
  const auto linear = Identify(problem, MakeFitSetup(problem, {}).value(), options);
  ASSERT_TRUE(linear) << linear.error().message;
  EXPECT_NEAR(linear->parameters[0], 0.3, 1e-4) << "linear intervals do not leave the minimum";
  EXPECT_TRUE(linear->warnings.empty());

  options.profiles = true;
  const auto found = Identify(problem, MakeFitSetup(problem, {}).value(), options);
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_NEAR(found->result.cost, 10, 1e-9);
  EXPECT_NEAR(found->parameters[0], 0.6, 1e-3);
  ASSERT_EQ(found->uncertainty.parameters.size(), 1U);
  EXPECT_EQ(found->uncertainty.parameters[0].value, found->parameters[0]) << "done again from there";
  ASSERT_EQ(found->warnings.size(), 1U);
  EXPECT_EQ(found->warnings[0].kind, WarningKind::kBetterPointTaken);
  EXPECT_NEAR(found->warnings[0].numbers[0], 10.125, 1e-6);
  EXPECT_EQ(found->warnings[0].numbers[1], found->result.cost);
}

TEST(Identification, FailedEvaluationsAreAWarningWithTheFirstReason) {
  ToyProblem problem({toy::MakeParameter("a", 0, 1, 0.75)}, {toy::MakeBlock("t", "y", 5, 1)},
                     [](const Block&, double, const Vector& p, Vector* gradient) -> Result<double> {
                       if (p[0] < 0.5) return Fail("the foot slips at a = {}", p[0]);
                       if (gradient != nullptr) *gradient << 1;
                       return p[0];
                     });
  problem.Measure(Values({0.6}), [](const Block&, int i) { return 0.01 * (i % 2); });
  IdentificationOptions options;
  options.solver = "sa";
  options.evaluator.budget.max_evaluations = 300;
  const Identification found = toy::IdentifyLine(problem, options);
  ASSERT_GT(found.failures, 0);
  ASSERT_FALSE(found.warnings.empty());
  const Warning& warning = found.warnings.front();
  EXPECT_EQ(warning.kind, WarningKind::kFailedEvaluations);
  EXPECT_THAT(warning.numbers,
              testing::ElementsAre(found.failures, found.record.evaluations(), found.failures));
  EXPECT_THAT(warning.names, testing::ElementsAre(warning.message));
  EXPECT_THAT(warning.message, HasSubstr("the foot slips"));
}

TEST(Identification, NoPredictionAnywhereIsNoAnswer) {
  const ToyProblem problem({toy::MakeParameter("a", 0, 1, 0.5)}, {toy::MakeBlock("t", "y", 3, 1)},
                           [](const Block&, double, const Vector&, Vector*) -> Result<double> {
                             return Fail("the robot falls at t = 0.3 s");
                           });
  const Identification none = toy::IdentifyLine(problem);
  EXPECT_EQ(none.result.stop.kind, Termination::kNoPrediction);
  EXPECT_FALSE(none.result.stop.usable());
  EXPECT_EQ(none.parameters.size(), 0);
  EXPECT_THAT(none.result.stop.test, HasSubstr("the robot falls at t = 0.3 s"));
}

TEST(Identification, AnUnknownSolverIsAnError) {
  const ToyProblem problem = LineProblem();
  IdentificationOptions options;
  options.solver = "cere";
  EXPECT_THAT(ErrorOf(Identify(problem, MakeFitSetup(problem, {}).value(), options)),
              HasSubstr("did you mean 'ceres'"));
}

}  // namespace
}  // namespace sinew
