// Causes chosen by cross-validation over trials, where an unknown misfit dominates the noise.
#include "identify/diagnosis/select/cross_validated_search.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <memory>
#include <string>

#include "base/decompositions.h"
#include "tests/identify/diagnosis/linear_laws.h"
#include "tests/identify/support/rippled_problem.h"

namespace sinew::diagnosis {
namespace {

/// Everything that a search refers to.
struct Case {
  explicit Case(const LinearLaws& laws) : problem(laws), setup(*MakeFitSetup(laws, {})), scale(laws) {
    candidates = ListCandidates(problem, setup);
    refitter = std::make_unique<Refitter>(problem, setup, candidates);
    search = std::make_unique<CrossValidatedSearch>(problem, *refitter, candidates, scale, options);
  }
  [[nodiscard]] Refit Base() const { return refitter->Fit({}, {setup.rest}); }
  [[nodiscard]] Result<ScoredModel> ScoredBase() const {
    return ScoreModel(problem, candidates, Base(), 0.05, 1);
  }
  [[nodiscard]] FittedSet LeftOut(const std::vector<int>& released, const Vector& start) const {
    std::vector<FittedSet> sets{FittedSet(released)};
    sets.front().point = start;
    search->fitter().LeaveOut(sets);
    return sets.front();
  }
  [[nodiscard]] std::vector<int> SetOf(const std::vector<std::string>& effects) const {
    std::vector<int> set;
    for (std::size_t c = 0; c < candidates.size(); ++c) {
      if (std::count(effects.begin(), effects.end(), candidates[c].effect) > 0)
        set.push_back(static_cast<int>(c));
    }
    return set;
  }
  [[nodiscard]] std::vector<std::string> NamesOf(const std::vector<int>& set) const {
    std::vector<std::string> names;
    for (const int c : set) names.push_back(candidates[static_cast<std::size_t>(c)].effect);
    std::sort(names.begin(), names.end());
    return names;
  }

  const LinearLaws& problem;
  FitSetup setup;
  MisfitScale scale;
  DiagnosisOptions options;
  std::vector<Candidate> candidates;
  std::unique_ptr<Refitter> refitter;
  std::unique_ptr<CrossValidatedSearch> search;
};

/// A ramp of mean zero in trials of 100 samples: 0.3 (time - 5) has a small effect alone, the offset of 0.9
/// only together with the drift. And a slow error that differs between trials and that no effect explains.
LinearLaws::Truth Hidden() {
  LinearLaws::Truth truth;
  truth.noise = 0.005;
  truth.effects = {{"drift_size", 0.3}, {"offset_size", 0.9}};
  truth.slow_error = 0.15;
  return truth;
}

TEST(CrossValidatedSearch, OfManyTrialsTwentyAreSearched) {
  const LinearLaws many({}, 1, 50, 1);
  const Case of_many(many);
  const std::vector<std::string> all = TrainingTrials(many);
  const std::vector<std::string> some = TrainingTrials(of_many.search->fitter().searched());
  ASSERT_EQ(some.size(), 20U);
  EXPECT_EQ(some.front(), all.front());
  EXPECT_EQ(some[10], all[25]) << "evenly";
  for (const Fold& fold : of_many.search->fitter().folds()) EXPECT_EQ(fold.trials.size(), 2U);
  const LinearLaws few({}, 1, 20, 1);
  EXPECT_EQ(TrainingTrials(Case(few).search->fitter().searched()), TrainingTrials(few));
}

// By normal equations on the other trials.
TEST(CrossValidatedSearch, LeftOutErrorMatchesAHandCalculation) {
  const LinearLaws problem(Hidden(), 2, 6, 2, 100);
  const Case one(problem);
  const LeastSquares fit(problem, one.setup);
  auto workspace = fit.NewWorkspace();
  SparseJacobian jacobian = fit.NewJacobian();
  Vector residual;
  const Vector x = fit.Start();
  ASSERT_TRUE(fit.Evaluate(x, workspace, residual, &jacobian));
  const Matrix design = jacobian.Dense(fit.residuals(), fit.variables());
  double logarithms = 0;
  for (int left_out = 0; left_out < 6; ++left_out) {
    Matrix normal = Matrix::Zero(2, 2);
    Vector right = Vector::Zero(2);
    for (int t = 0; t < 6; ++t) {
      if (t == left_out) continue;
      const Matrix rows = design.middleRows(100 * t, 100);
      normal += rows.transpose() * rows;
      right -= rows.transpose() * residual.segment(100 * t, 100);
    }
    const Vector predicted = residual.segment(100 * left_out, 100) +
                             design.middleRows(100 * left_out, 100) * normal.ldlt().solve(right);
    logarithms += std::log(predicted.norm() / 10);
  }
  const double by_hand = std::exp(logarithms / 6);
  // The fits end within 1e-4 of the least cost, steps of a linear problem much nearer.
  EXPECT_NEAR(one.LeftOut({}, one.setup.rest).left_out_error, by_hand, 1e-4 * by_hand);
}

TEST(CrossValidatedSearch, OnlySetsWithManyProbesThatALowerCostIsFoundForAreFittedAgain) {
  const LinearLaws problem(Hidden(), 2, 6, 2, 100);
  Case one(problem);
  const SetFitter& fitter = one.search->fitter();
  std::vector<FittedSet> sets{FittedSet(one.SetOf({"offset"}))};
  fitter.Fit(sets, {{one.setup.rest}}, SetFitter::kTolerance, 1);
  fitter.LeaveOut(sets);
  const FittedSet fitted = sets.front();
  ASSERT_TRUE(std::isfinite(fitted.left_out_error));
  Candidate& offset = one.candidates[static_cast<std::size_t>(fitted.released.front())];
  FittedSet missed = fitted;
  for (const int index : offset.parameters) missed.point[index] += 1;
  missed.fitted_error = 10 * fitted.fitted_error;
  sets = {missed};
  fitter.FitFromProbes(sets);
  EXPECT_EQ(sets[0].point, missed.point) << "no effect of many probe values";
  offset.probes.resize(13);
  sets = {fitted, missed};
  fitter.FitFromProbes(sets);
  EXPECT_EQ(sets[0].left_out_error, fitted.left_out_error);
  EXPECT_EQ(sets[0].point, fitted.point);
  EXPECT_NEAR(sets[1].fitted_error, fitted.fitted_error, 1e-3 * fitted.fitted_error);
  EXPECT_LT((sets[1].point - fitted.point).norm(), 1e-2);
  EXPECT_TRUE(std::isinf(sets[1].left_out_error)) << "of the point before";
}

TEST(CrossValidatedSearch, ARippleIsFittedAgainFromOtherPeriods) {
  const rippled::Rippled problem;
  const FitSetup setup = *MakeFitSetup(problem, {});
  const std::vector<Candidate> candidates = ListCandidates(problem, setup);
  const Refitter refitter(problem, setup, candidates);
  const DiagnosisOptions options;
  const SetFitter fitter(problem, refitter, candidates, options);
  ASSERT_EQ(candidates.front().effect, "ripple");
  std::vector<FittedSet> sets{FittedSet({0})};
  Vector start = setup.rest;
  start[rippled::kRipplePeriod] = 0.5;
  fitter.Fit(sets, {{start}}, SetFitter::kTolerance, 1);
  EXPECT_GT(sets.front().point[rippled::kRipplePeriod], 0.2) << "the search alone should miss it";
  fitter.FitFromProbes(sets);
  EXPECT_NEAR(sets.front().point[rippled::kRipplePeriod], rippled::kPeriod, 1e-4);
}

TEST(CrossValidatedSearch, AnInterruptionLeavesNoErrorOfLeftOutData) {
  const LinearLaws problem({}, 2, 4, 0);
  Case one(problem);
  const std::atomic<bool> stop = true;
  one.options.interrupt = &stop;
  // Zero, as of a perfect set, would make it the answer.
  EXPECT_EQ(one.LeftOut({}, one.setup.rest).left_out_error, std::numeric_limits<double>::infinity());
  EXPECT_TRUE(one.LeftOut({}, one.setup.rest).fold_errors.empty());
}

TEST(CrossValidatedSearch, NuisanceOfLeftOutTrialsIsFitted) {
  LinearLaws::Truth truth;
  truth.starts = true;
  const LinearLaws problem(truth, 2, 4, 0);
  const Case one(problem);
  // Decaying initial values are fitted in left-out trials too: the noise remains, less one value per trial;
  // three standard deviations of a root mean square of 1000.
  EXPECT_NEAR(one.LeftOut({}, one.setup.rest).left_out_error, truth.noise,
              3 * truth.noise / std::sqrt(2000.0));
}

// Without the first window of a trial its start, which has died away in the rest, is hardly determined: a fit
// to the rest alone leaves it several times the noise off, in one of ten cases or more.
TEST(CrossValidatedSearch, TheFirstWindowIsPredictedAsWellAsTheOthers) {
  LinearLaws::Truth truth;
  truth.starts = true;
  double largest = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const LinearLaws problem(truth, seed, 1, 0);
    const Case one(problem);
    const Refit base = one.Base();
    ASSERT_TRUE(base.usable());
    const std::vector<double> errors = one.LeftOut({}, base.point).fold_errors;
    ASSERT_EQ(errors.size(), 6U);
    largest = std::max(largest, errors.front());
  }
  EXPECT_LT(largest, 2 * truth.noise);
}

TEST(CrossValidatedSearch, FindsACauseThatImprovesOnlyTogetherWithAnother) {
  int right = 0;
  constexpr int kCases = 2;
  for (std::uint64_t seed = 1; seed <= kCases; ++seed) {
    const LinearLaws problem(Hidden(), seed, 6, 0, 100);
    Case one(problem);
    const auto base = one.ScoredBase();
    ASSERT_TRUE(base) << base.error().message;
    ASSERT_TRUE(one.scale.Dominates(base->refit.noise));
    const auto found = one.search->Run(*base);
    ASSERT_TRUE(found) << found.error().message;
    ASSERT_TRUE(found->has_value());
    const CrossValidatedSearch::Outcome& outcome = **found;
    EXPECT_TRUE(outcome.misfit_left);
    right += one.NamesOf(outcome.released) == std::vector<std::string>{"drift", "offset"} ? 1 : 0;
    // The second effect improves nothing alone, but does together with the first.
    EXPECT_LT(outcome.error, 0.6 * outcome.base_error) << seed;
    EXPECT_GT(one.LeftOut(one.SetOf({"offset"}), base->refit.point).left_out_error, 0.97 * outcome.base_error)
        << seed;
    EXPECT_GT(one.LeftOut(one.SetOf({"drift"}), base->refit.point).left_out_error, outcome.error / 0.97)
        << seed;
    EXPECT_NEAR(outcome.base_error, one.LeftOut({}, base->refit.point).left_out_error,
                1e-4 * outcome.base_error);
    EXPECT_EQ(outcome.left_out_shares.size(), outcome.released.size());
    for (const auto& [c, share] : outcome.left_out_shares) EXPECT_LT(share, 0.85) << seed;
    EXPECT_EQ(outcome.model.released, outcome.released);
    ASSERT_GT(outcome.ladder.size(), 2U);
    EXPECT_EQ(outcome.ladder[0].error, outcome.base_error);
    EXPECT_LE(outcome.ladder[2].error, outcome.error) << seed;
    EXPECT_TRUE(outcome.model.usable());
  }
  EXPECT_EQ(right, kCases);
}

// The noise of the channel is visible: where two causes leave no more, sets of three are not tried.
TEST(CrossValidatedSearch, EndsWhereOnlyVisibleNoiseIsLeft) {
  LinearLaws::Truth truth = Hidden();
  for (const double slow_error : {0.0, 0.15}) {
    truth.slow_error = slow_error;
    const LinearLaws problem(truth, 1, 6, 0, 100);
    Case one(problem);
    const auto base = one.ScoredBase();
    ASSERT_TRUE(base) << base.error().message;
    ASSERT_TRUE(one.scale.Dominates(base->refit.noise));
    const auto found = one.search->Run(*base);
    ASSERT_TRUE(found) << found.error().message;
    ASSERT_TRUE(found->has_value());
    const CrossValidatedSearch::Outcome& outcome = **found;
    EXPECT_EQ(one.NamesOf(outcome.released), (std::vector<std::string>{"drift", "offset"}));
    EXPECT_EQ(outcome.misfit_left, slow_error > 0);
    // Entries of no cause, of one and of two.
    if (slow_error > 0) {
      EXPECT_GT(outcome.ladder.size(), 3U);
    } else {
      EXPECT_EQ(outcome.ladder.size(), 3U);
    }
  }
}

// An effect that its bound holds at its null is the same model as that without it, and no cause.
TEST(CrossValidatedSearch, AMemberThatChangesNothingIsTakenOut) {
  LinearLaws::Truth truth = Hidden();
  truth.effects = {{"drift_size", 0.3}, {"quadratic_size", -0.5}};  // its lower bound is 0
  const LinearLaws problem(truth, 1, 6, 0, 100);
  Case one(problem);
  const auto fitted = [&](const std::vector<std::string>& effects) {
    std::vector<FittedSet> sets{FittedSet(one.SetOf(effects))};
    one.search->fitter().Fit(sets, {{one.setup.rest}}, SetFitter::kTolerance, 1);
    return sets.front();
  };
  const FittedSet both = fitted({"drift", "quadratic"});
  const FittedSet rest = one.search->fitter().WithoutIdle(both);
  EXPECT_EQ(one.NamesOf(rest.released), std::vector<std::string>{"drift"});
  EXPECT_EQ(rest.point, both.point);
  EXPECT_NEAR(rest.fitted_error, both.fitted_error, 1e-12);
  EXPECT_EQ(one.search->fitter().WithoutIdle(rest).released, rest.released) << "the drift acts";

  const auto base = one.ScoredBase();
  ASSERT_TRUE(base) << base.error().message;
  const auto found = one.search->Run(*base);
  ASSERT_TRUE(found) << found.error().message;
  ASSERT_TRUE(found->has_value());
  const CrossValidatedSearch::Outcome& outcome = **found;
  EXPECT_EQ(std::count(outcome.released.begin(), outcome.released.end(), one.SetOf({"quadratic"}).front()),
            0);
}

// After the search a further cause has to lower the residual's deviation by 2 %, however significant it is.
TEST(CrossValidatedSearch, NoFurtherCauseForAThousandthOfTheMisfit) {
  LinearLaws::Truth truth = Hidden();
  truth.slow_error = 0;
  // Significant are both: without the rule each is named.
  for (const double size : {0.0013, 0.004}) {
    truth.effects = {{"drift_size", 0.3}, {"offset_size", 0.9}, {"quadratic_size", size}};
    const LinearLaws problem(truth, 1, 6, 2, 100);
    const auto setup = MakeFitSetup(problem, {});
    ASSERT_TRUE(setup);
    const auto d = Diagnose(problem, *setup, {});
    ASSERT_TRUE(d) << d.error().message;
    std::vector<std::string> names;
    for (const Cause& cause : d->causes) names.push_back(cause.effect);
    std::sort(names.begin(), names.end());
    std::vector<std::string> expected = {"drift", "offset"};
    if (size > 0.002) expected.emplace_back("quadratic");
    EXPECT_EQ(names, expected) << size;
  }
}

// An effect that improves the fitted trials a little and the left-out ones not at all is not added.
TEST(CrossValidatedSearch, AddsNoCauseThatLeftOutTrialsDoNotNeed) {
  LinearLaws::Truth truth = Hidden();
  truth.effects.clear();
  truth.slow_error = 1;
  for (std::uint64_t seed = 1; seed <= 2; ++seed) {
    const LinearLaws problem(truth, seed, 6, 0, 100);
    Case one(problem);
    const auto base = one.ScoredBase();
    ASSERT_TRUE(base) << base.error().message;
    const auto found = one.search->Run(*base);
    ASSERT_TRUE(found) << found.error().message;
    ASSERT_TRUE(found->has_value());
    const CrossValidatedSearch::Outcome& outcome = **found;
    for (const auto& [c, share] : outcome.left_out_shares) {
      EXPECT_LT(share, 0.85) << one.candidates[static_cast<std::size_t>(c)].effect << " " << seed;
    }
    EXPECT_LE(outcome.error, outcome.base_error);
  }
}

TEST(CrossValidatedSearch, AnInterruptEndsItWithoutACause) {
  const LinearLaws problem(Hidden(), 1, 6, 0, 100);
  Case one(problem);
  const auto base = one.ScoredBase();
  ASSERT_TRUE(base) << base.error().message;
  const std::atomic<bool> pressed{true};
  one.options.interrupt = &pressed;
  const auto found = one.search->Run(*base);
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_FALSE(*found) << "nothing was tried";
}

// A problem that predicts all training trials or none of them.
class AllOrNothing final : public Problem {
 public:
  explicit AllOrNothing(const LinearLaws& laws) : laws_(laws) {}
  [[nodiscard]] const std::vector<Parameter>& parameters() const override { return laws_.parameters(); }
  [[nodiscard]] const Layout& layout() const override { return laws_.layout(); }
  [[nodiscard]] const std::vector<Effect>& effects() const override { return laws_.effects(); }
  Status Predict(const Query& query, Workspace& workspace, Prediction& prediction) const override {
    int wanted = 0;
    int all = 0;
    for (std::size_t b = 0; b < layout().size(); ++b) {
      if (layout()[b].role != BlockRole::kTrain) continue;
      ++all;
      wanted += query.blocks[b] ? 1 : 0;
    }
    if (wanted > 0 && wanted < all) return Fail("a part of the trials");
    return laws_.Predict(query, workspace, prediction);
  }

 private:
  const LinearLaws& laws_;
};

TEST(CrossValidatedSearch, WhereNothingCanBeLeftOutTheDiagnosisGoesOnByLikelihood) {
  const LinearLaws laws(Hidden(), 1, 6, 2, 100);
  const AllOrNothing problem(laws);
  const auto setup = MakeFitSetup(problem, {});
  ASSERT_TRUE(setup);
  const auto d = Diagnose(problem, *setup, {});
  ASSERT_TRUE(d) << d.error().message;
  EXPECT_TRUE(d->left_out.empty());
  EXPECT_NE(d->verdict, DiagnosisVerdict::kAdequate);
}

TEST(CrossValidatedSearch, DiagnosisListsTheLeftOutTrials) {
  const LinearLaws problem(Hidden(), 1, 6, 2, 100);
  const auto setup = MakeFitSetup(problem, {});
  ASSERT_TRUE(setup);
  const auto d = Diagnose(problem, *setup, {});
  ASSERT_TRUE(d) << d.error().message;
  EXPECT_EQ(d->verdict, DiagnosisVerdict::kUnexplained);
  ASSERT_EQ(d->left_out.size(), 6U);
  ASSERT_EQ(d->causes.size(), 2U);
  for (const Cause& cause : d->causes) {
    EXPECT_TRUE(cause.effect == "drift" || cause.effect == "offset") << cause.effect;
    EXPECT_GT(cause.left_out, 0);
    EXPECT_LT(cause.left_out, 0.85);
    // The jackknife's intervals include the scatter of the parameters by the slow error.
    const double truth = cause.effect == "drift" ? 0.3 : 0.9;
    ASSERT_FALSE(cause.parameters.empty());
    EXPECT_LT(cause.parameters[0].ci95[0], truth) << cause.effect;
    EXPECT_GT(cause.parameters[0].ci95[1], truth) << cause.effect;
  }
  EXPECT_EQ(d->left_out[0].trials, std::vector<std::string>{"trial_1"});
  EXPECT_FALSE(d->left_out[0].window);
  EXPECT_EQ(d->left_out[1].trials, std::vector<std::string>{"trial_2"});
  ASSERT_GT(d->ladder.size(), 2U);
  EXPECT_EQ(d->ladder[0].error, 1);
  EXPECT_LT(d->ladder[2].error, 0.6);
  const auto warning = std::find_if(d->warnings.begin(), d->warnings.end(),
                                    [](const Warning& w) { return w.kind == WarningKind::kCrossValidated; });
  ASSERT_NE(warning, d->warnings.end());
  EXPECT_EQ(warning->numbers, (std::vector<double>{6, 6})) << "all trials were searched";
}

}  // namespace
}  // namespace sinew::diagnosis
