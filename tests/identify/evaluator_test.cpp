#include "identify/execution/evaluator.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "base/constants.h"
#include "base/random.h"
#include "identify/execution/failure_reasons.h"
#include "tests/identify/support/toy_problem.h"

namespace sinew {
namespace {

using toy::MakeBlock;
using toy::MakeParameter;
using toy::ToyFit;
using toy::ToyProblem;
using toy::Values;
using Outcome = Evaluator::Outcome;
using StopCause = Evaluator::StopCause;

// A line through (0, 1) and (1, 3) measured without noise; counts its predictions, and has none where a < -1.
class EvaluatorTest : public testing::Test {
 protected:
  EvaluatorTest() {
    problem_.Measure(Values({1, 2}), [](const Block&, int) { return 0.0; });
    fit_ = std::make_unique<ToyFit>(problem_);
    predictions_ = 0;
  }

  Evaluator Make(Evaluator::Options options = {}) const { return Evaluator(fit_->view, std::move(options)); }
  [[nodiscard]] Vector At(double a, double b) const { return fit_->view.Variables(Values({a, b})); }

  int predictions_ = 0;  // of samples
  ToyProblem problem_{{MakeParameter("a", -4, 4, 0), MakeParameter("b", -4, 4, 0)},
                      {MakeBlock("t", "y", 2, 1)},
                      [this](const Block&, double t, const Vector& p, Vector* gradient) -> Result<double> {
                        ++predictions_;
                        if (p[0] < -1) return Fail("a = {} is out of reach", p[0]);
                        if (gradient != nullptr) *gradient << 1, (p[1] > 3.5 ? std::nan("") : t);
                        return p[0] + p[1] * t;
                      },
                      {{"a at most 3", Values({1, 0}), -3}}};
  std::unique_ptr<ToyFit> fit_;
};

TEST_F(EvaluatorTest, RecordsEveryEvaluationAndTheBest) {
  Evaluator evaluator = Make();
  EXPECT_FALSE(evaluator.has_best());
  double cost = 0;
  ASSERT_EQ(evaluator.Cost(At(0, 0), cost), Outcome::kOk);
  EXPECT_EQ(cost, 0.5 * (1 + 9));
  ASSERT_EQ(evaluator.Cost(At(1, 1), cost), Outcome::kOk);
  EXPECT_EQ(cost, 0.5);
  Vector residuals;
  ASSERT_EQ(evaluator.Residuals(At(0, 1), residuals, nullptr), Outcome::kOk);
  EXPECT_EQ(residuals, Values({-1, -2}));
  EXPECT_EQ(evaluator.evaluations(), 3);
  EXPECT_EQ(evaluator.best().cost, 0.5);
  EXPECT_EQ(evaluator.best().x, At(1, 1));
  EXPECT_EQ(evaluator.trace()[2].cost, 2.5);
  EXPECT_GE(evaluator.trace()[2].seconds, evaluator.trace()[0].seconds);
}

TEST_F(EvaluatorTest, GradientIsTheJacobianTimesTheResiduals) {
  constexpr double kRounding = 1e-14;
  Evaluator evaluator = Make();
  double cost = 0;
  Vector gradient;
  ASSERT_EQ(evaluator.Gradient(At(0, 1), cost, gradient), Outcome::kOk);
  EXPECT_EQ(cost, 2.5);
  // r = (-1, -2), dr/dx = 8 (1, 0; 1, 1)
  EXPECT_LT((gradient - Values({-24, -16})).norm(), kRounding);
  EXPECT_EQ(evaluator.evaluations(), 1);
}

TEST_F(EvaluatorTest, StopsAtTheBudgetOfEvaluations) {
  Evaluator::Options options;
  options.budget.max_evaluations = 3;
  Evaluator evaluator = Make(options);
  double cost = 0;
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(evaluator.remaining().max_evaluations, 3 - i);
    ASSERT_EQ(evaluator.Cost(At(0, i), cost), Outcome::kOk);
  }
  const int so_far = predictions_;
  EXPECT_EQ(evaluator.Cost(At(0, 0), cost), Outcome::kStop);
  EXPECT_EQ(cost, kInfinity);
  EXPECT_EQ(predictions_, so_far);
  EXPECT_EQ(evaluator.evaluations(), 3);
  EXPECT_EQ(evaluator.stop_cause(), StopCause::kEvaluations);
}

TEST_F(EvaluatorTest, AShareLeavesTheRestOfTheBudget) {
  Evaluator::Options options;
  options.budget.max_evaluations = 4;
  Evaluator evaluator = Make(options);
  double cost = 0;
  ASSERT_EQ(evaluator.Cost(At(0, 0), cost), Outcome::kOk);
  evaluator.BeginShare(2);
  ASSERT_EQ(evaluator.Cost(At(0, 1), cost), Outcome::kOk);
  ASSERT_EQ(evaluator.Cost(At(0, 2), cost), Outcome::kOk);
  EXPECT_EQ(evaluator.Cost(At(0, 3), cost), Outcome::kStop);
  evaluator.EndShare();
  EXPECT_EQ(evaluator.stop_cause(), StopCause::kNone);
  ASSERT_EQ(evaluator.Cost(At(0, 3), cost), Outcome::kOk);
  EXPECT_EQ(evaluator.Cost(At(1, 3), cost), Outcome::kStop);

  Evaluator another = Make(options);
  another.BeginShare(100);  // no share is larger than the budget
  for (int i = 0; i < 4; ++i) ASSERT_EQ(another.Cost(At(0, i), cost), Outcome::kOk);
  EXPECT_EQ(another.Cost(At(0, 0), cost), Outcome::kStop);
}

TEST_F(EvaluatorTest, StopsWhenTheTimeIsUp) {
  Evaluator::Options options;
  options.budget.max_seconds = 0;
  Evaluator evaluator = Make(options);
  double cost = 0;
  EXPECT_EQ(evaluator.Cost(At(0, 0), cost), Outcome::kStop);
  EXPECT_EQ(evaluator.stop_cause(), StopCause::kSeconds);
  EXPECT_EQ(evaluator.evaluations(), 0);
}

TEST_F(EvaluatorTest, StopsWhenInterrupted) {
  std::atomic<bool> interrupt{false};
  Evaluator::Options options;
  options.interrupt = &interrupt;
  Evaluator evaluator = Make(options);
  double cost = 0;
  ASSERT_EQ(evaluator.Cost(At(0, 0), cost), Outcome::kOk);
  interrupt = true;
  EXPECT_EQ(evaluator.Cost(At(0, 1), cost), Outcome::kStop);
  EXPECT_EQ(evaluator.stop_cause(), StopCause::kInterrupted);
}

TEST_F(EvaluatorTest, StopsAtTheTarget) {
  Evaluator::Options options;
  options.target_cost = 0.5;
  options.budget.max_evaluations = 2;
  Evaluator evaluator = Make(options);
  double cost = 0;
  ASSERT_EQ(evaluator.Cost(At(0, 0), cost), Outcome::kOk);
  EXPECT_FALSE(evaluator.MustStop());
  ASSERT_EQ(evaluator.Cost(At(1, 1), cost), Outcome::kOk);
  EXPECT_EQ(evaluator.Cost(At(1, 2), cost), Outcome::kStop);
  EXPECT_EQ(evaluator.stop_cause(), StopCause::kTarget)
      << "reached with the last evaluation of the budget, it is reached all the same";
}

TEST_F(EvaluatorTest, FailuresAreCountedAndNeverBest) {
  Evaluator evaluator = Make();
  double cost = 0;
  EXPECT_EQ(evaluator.Cost(At(-2, 0), cost), Outcome::kFailed);
  EXPECT_EQ(cost, kInfinity);
  Vector residuals;
  EXPECT_EQ(evaluator.Residuals(At(-3, 0), residuals, nullptr), Outcome::kFailed);
  EXPECT_FALSE(evaluator.has_best());
  EXPECT_EQ(evaluator.evaluations(), 2);
  EXPECT_EQ(evaluator.trace()[0].cost, kInfinity);
  ASSERT_EQ(evaluator.Cost(At(0, 0), cost), Outcome::kOk);
  EXPECT_EQ(evaluator.best().x, At(0, 0));
  EXPECT_EQ(evaluator.failures(), 2);
  EXPECT_EQ(evaluator.first_failure(), "a = -2 is out of reach");
}

TEST_F(EvaluatorTest, ADerivativeThatIsNotFiniteIsAFailure) {
  Evaluator evaluator = Make();
  double cost = 0;
  Vector gradient;
  EXPECT_EQ(evaluator.Gradient(At(0, 3.75), cost, gradient), Outcome::kFailed);
  EXPECT_EQ(evaluator.first_failure(), "a derivative is not finite");
  EXPECT_EQ(evaluator.Cost(At(0, 3.75), cost), Outcome::kOk) << "the cost alone needs no derivative";
}

TEST_F(EvaluatorTest, PointsThatViolateAConstraintAreRejectedOrEvaluatedButNeverBest) {
  Evaluator evaluator = Make();
  double cost = 0;
  EXPECT_EQ(evaluator.Cost(At(3.5, 0), cost), Outcome::kFailed);
  EXPECT_EQ(predictions_, 0);
  EXPECT_EQ(evaluator.first_failure(), "constraint 'a at most 3' is violated");
  EXPECT_EQ(evaluator.Cost(At(3.5, 0), cost, Evaluator::Infeasible::kEvaluate), Outcome::kOk);
  EXPECT_EQ(cost, 0.5 * (2.5 * 2.5 + 0.5 * 0.5));
  EXPECT_EQ(evaluator.infeasible(), 2);
  EXPECT_FALSE(evaluator.has_best());
  ASSERT_EQ(evaluator.Violated(At(3.5, 0)), "a at most 3");
  EXPECT_EQ(evaluator.Violated(At(3, 0)), std::nullopt) << "on the boundary is feasible";
}

TEST_F(EvaluatorTest, ProgressIsReportedAtEveryEvaluation) {
  std::vector<double> best;
  Evaluator::Options options;
  options.progress = [&](const Progress& progress, const Evaluator& evaluator) {
    EXPECT_EQ(progress.evaluations, evaluator.evaluations());
    best.push_back(progress.best_cost);
  };
  Evaluator evaluator = Make(options);
  double cost = 0;
  evaluator.Cost(At(-2, 0), cost);
  evaluator.Cost(At(1, 1), cost);
  evaluator.Cost(At(0, 0), cost);
  EXPECT_EQ(best, (std::vector<double>{kInfinity, 0.5, 0.5}));
}

// A search that depends on every cost, to the last bit.
void AutocorrelationExcess(Evaluator& evaluator, int steps) {
  Random random(5);
  double cost = 0;
  double bias = 0;
  for (int i = 0; i < steps; ++i) {
    const Vector x = Values({random.Uniform(), std::fmod(random.Uniform() + bias, 1.0)});
    const Outcome outcome = evaluator.Cost(x, cost);
    if (outcome == Outcome::kStop) return;
    if (outcome == Outcome::kOk) bias = std::fmod(1e9 * cost, 1.0);
  }
}

TEST_F(EvaluatorTest, AReplayedRunIsTheUninterruptedRunToTheLastBit) {
  Evaluator whole = Make();
  AutocorrelationExcess(whole, 200);
  ASSERT_GT(whole.failures(), 0) << "the run must contain failures for the test to mean something";

  Evaluator::Options until;
  until.budget.max_evaluations = 80;
  Evaluator interrupted = Make(until);
  AutocorrelationExcess(interrupted, 200);
  ASSERT_EQ(interrupted.evaluations(), 80);

  predictions_ = 0;
  Evaluator::Options resumed_options;
  resumed_options.replay = interrupted.record();
  Evaluator resumed = Make(resumed_options);
  AutocorrelationExcess(resumed, 80);
  EXPECT_EQ(predictions_, 0) << "what was recorded is not predicted again";
  Evaluator on = Make(resumed_options);
  AutocorrelationExcess(on, 200);
  ASSERT_EQ(on.evaluations(), 200);
  for (std::size_t i = 0; i < 200; ++i) {
    ASSERT_EQ(on.trace()[i].x, whole.trace()[i].x) << i;
    ASSERT_EQ(on.trace()[i].cost, whole.trace()[i].cost) << i;
  }
  EXPECT_EQ(on.failures(), whole.failures());
  EXPECT_EQ(on.best().x, whole.best().x);
}

TEST_F(EvaluatorTest, ASearchOfWhichNotAllPointsAreKeptIsReplayedAllTheSame) {
  Evaluator::Options options;
  options.most_entries = 16;
  Evaluator whole = Make(options);
  AutocorrelationExcess(whole, 400);
  options.budget.max_evaluations = 150;
  Evaluator stopped = Make(options);
  AutocorrelationExcess(stopped, 400);
  ASSERT_TRUE(stopped.record().thinned());

  options.budget = {};
  options.replay = stopped.record();
  Evaluator resumed = Make(options);
  predictions_ = 0;
  AutocorrelationExcess(resumed, 150);
  EXPECT_EQ(predictions_, 0) << "what was recorded is not predicted again";
  Evaluator on = Make(options);
  AutocorrelationExcess(on, 400);
  ASSERT_EQ(on.evaluations(), 400);
  ASSERT_EQ(on.trace().size(), whole.trace().size());
  for (std::size_t i = 0; i < whole.trace().size(); ++i) {
    EXPECT_EQ(on.trace()[i].evaluation, whole.trace()[i].evaluation) << i;
    EXPECT_EQ(on.trace()[i].x, whole.trace()[i].x) << i;
    EXPECT_EQ(on.trace()[i].cost, whole.trace()[i].cost) << i;
    EXPECT_EQ(on.trace()[i].failure, whole.trace()[i].failure) << i;
  }
  EXPECT_EQ(on.failures(), whole.failures());
  EXPECT_EQ(on.first_failure(), whole.first_failure());
  EXPECT_EQ(on.best().x, whole.best().x);
  const auto reasons = whole.record().reasons().MostFrequentFirst();
  const auto again = on.record().reasons().MostFrequentFirst();
  ASSERT_EQ(again.size(), reasons.size());
  EXPECT_EQ(again[0].message, reasons[0].message);
  EXPECT_EQ(again[0].count, reasons[0].count);
}

TEST_F(EvaluatorTest, AMemoryBudgetStopsTheSearch) {
  Evaluator::Options options;
  options.budget.max_memory = 1;
  Evaluator none = Make(options);
  double cost = 0;
  EXPECT_EQ(none.Cost(At(0, 0), cost), Outcome::kStop);
  EXPECT_EQ(none.stop_cause(), StopCause::kMemory);
  options.budget.max_memory = 1e15;
  Evaluator enough = Make(options);
  EXPECT_EQ(enough.Cost(At(0, 0), cost), Outcome::kOk);
}

// A search that depends on every residual and derivative, to the last bit.
void DescendOnDerivatives(Evaluator& evaluator, int steps) {
  SparseJacobian jacobian = evaluator.fit().NewJacobian();
  Vector residuals;
  Vector x = evaluator.fit().Start();
  for (int i = 0; i < steps; ++i) {
    if (evaluator.Residuals(x, residuals, i % 3 == 2 ? nullptr : &jacobian) == Outcome::kStop) return;
    double sum = residuals.sum();
    for (const SparseJacobian::Piece& piece : jacobian.pieces) sum += piece.values.sum();
    for (double& value : x) value = std::abs(std::sin(1e6 * (sum + value)));
  }
}

TEST_F(EvaluatorTest, ResidualsAndDerivativesAreKeptAsFarAsThereIsRoom) {
  Evaluator whole = Make();
  DescendOnDerivatives(whole, 12);
  EXPECT_TRUE(whole.kept_residuals().empty());

  Evaluator::Options keeping;
  keeping.most_kept = 1000;
  keeping.budget.max_evaluations = 8;
  Evaluator stopped = Make(keeping);
  DescendOnDerivatives(stopped, 12);
  ASSERT_EQ(stopped.kept_residuals().size(), 8U - static_cast<std::size_t>(stopped.failures()));
  ASSERT_GT(stopped.kept_residuals().size(), 2U);

  Evaluator::Options resumed_options;
  resumed_options.most_kept = 1000;
  resumed_options.replay = stopped.record();
  resumed_options.replayed_residuals = stopped.kept_residuals();
  Evaluator again = Make(resumed_options);
  predictions_ = 0;
  DescendOnDerivatives(again, 8);
  EXPECT_EQ(predictions_, 0) << "what was kept is not predicted again";
  Evaluator resumed = Make(resumed_options);
  DescendOnDerivatives(resumed, 12);
  for (std::size_t i = 0; i < 12; ++i) {
    ASSERT_EQ(resumed.trace()[i].x, whole.trace()[i].x) << i;
    ASSERT_EQ(resumed.trace()[i].cost, whole.trace()[i].cost) << i;
  }
  EXPECT_EQ(resumed.kept_residuals().size(), 12U - static_cast<std::size_t>(resumed.failures()))
      << "a run that is stopped again keeps all of it";

  keeping.most_kept = stopped.kept_residuals()[0].numbers.size() + 1;
  Evaluator little = Make(keeping);
  DescendOnDerivatives(little, 8);
  EXPECT_EQ(little.kept_residuals().size(), 1U);
}

TEST_F(EvaluatorTest, FailuresAreCountedByReason) {
  Evaluator evaluator = Make();
  double cost = 0;
  evaluator.Cost(At(0, 0), cost);
  evaluator.Cost(At(3.5, 0), cost);
  for (const double a : {-2.0, -2.5, -3.25e-7 - 1}) evaluator.Cost(At(a, 0), cost);
  const auto reasons = evaluator.record().reasons().MostFrequentFirst();
  ASSERT_EQ(reasons.size(), 2U);
  EXPECT_EQ(reasons[0].message, "a = -2 is out of reach");
  EXPECT_EQ(reasons[0].count, 3);
  EXPECT_EQ(reasons[0].first, 2U);
  EXPECT_EQ(reasons[1].message, "constraint 'a at most 3' is violated");
  EXPECT_EQ(reasons[1].count, 1);
}

TEST_F(EvaluatorTest, TheFirstFailureHasItsReasonAlsoWhenResumed) {
  double cost = 0;
  Evaluator stopped = Make();
  stopped.Cost(At(3.5, 0), cost);
  ASSERT_EQ(stopped.failures(), 1);
  Evaluator::Options options;
  options.replay = stopped.record();
  Evaluator resumed = Make(options);
  resumed.Cost(At(3.5, 0), cost);
  EXPECT_EQ(resumed.first_failure(), stopped.first_failure());
}

TEST_F(EvaluatorTest, ARecordOfAnotherSearchIsIgnored) {
  Evaluator::Options options;
  options.replay = SearchRecord::OfAll({{0, 123, At(0, 1)}});
  Evaluator evaluator = Make(options);
  double cost = 0;
  ASSERT_EQ(evaluator.Cost(At(0, 0), cost), Outcome::kOk);
  EXPECT_EQ(cost, 5);
}

TEST_F(EvaluatorTest, AppendsTheRecordOfAChildInOrder) {
  Evaluator parent = Make();
  Evaluator child = Make();
  double cost = 0;
  parent.Cost(At(0, 0), cost);
  child.Cost(At(-2, 0), cost);
  child.Cost(At(1, 1), cost);
  child.Cost(At(3.5, 0), cost);
  parent.Absorb(child);
  EXPECT_EQ(parent.evaluations(), 4);
  EXPECT_EQ(parent.failures(), 2);
  EXPECT_EQ(parent.infeasible(), 1);
  EXPECT_EQ(parent.first_failure(), "a = -2 is out of reach");
  EXPECT_EQ(parent.best().x, At(1, 1));
  EXPECT_EQ(parent.trace()[1].x, At(-2, 0));
}

}  // namespace
}  // namespace sinew
