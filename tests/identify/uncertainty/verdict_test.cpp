#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "base/random.h"
#include "identify/statistics/distributions.h"
#include "identify/uncertainty/uncertainty.h"
#include "tests/identify/support/toy_problem.h"
#include "tests/identify/uncertainty/curves.h"

namespace sinew {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using toy::MakeBlock;
using toy::MakeParameter;
using toy::ToyFit;
using toy::ToyProblem;
using toy::Values;

// Everything that is linear is found up to rounding, through a condition of at most 1e4.
constexpr double kLinearAlgebra = 1e-9;
// The profile's own tolerance: kEndTolerance of the half-width.
constexpr double kVerdictProfileEnd = 3e-3;

/// y = offset + slope t, and a third parameter that does nothing.
ToyProblem LineProblem(std::vector<Parameter> extra = {}, double sigma = 0.1, int samples = 40) {
  std::vector<Parameter> parameters = {MakeParameter("offset", -10, 10, 0), MakeParameter("slope", 0, 20, 1)};
  parameters.insert(parameters.end(), extra.begin(), extra.end());
  ToyProblem problem(parameters, {MakeBlock("one", "height", samples, 3)}, Line);
  Random random(7);
  Vector truth = RestPoint(problem);
  truth.head(2) = Values({1.5, 4});
  problem.Measure(truth, [&](const Block&, int) { return sigma * random.Normal(); });
  return problem;
}

Uncertainty Analyse(const ToyFit& fit, const UncertaintyOptions& options = {}) {
  const Result<Uncertainty> answer = AnalyseUncertainty(fit.view, fit.view.Start(), options);
  EXPECT_TRUE(answer) << answer.error().message;
  return answer ? *answer : Uncertainty{};
}

TEST(Uncertainty, LinearRegressionMatchesItsClosedForm) {
  const ToyProblem problem = LineProblem();
  const ToyFit fit(problem);
  const Uncertainty answer = Analyse(fit);

  const Block& block = problem.layout()[0];
  const int n = block.samples();
  Matrix design(n, 2);
  Vector y(n);
  for (int i = 0; i < n; ++i) {
    design.row(i) << 1, block.prediction_time[static_cast<std::size_t>(i)];
    y[i] = block.measured[static_cast<std::size_t>(i)];
  }
  const Matrix inverse = (design.transpose() * design).inverse();
  const Vector best = inverse * design.transpose() * y;
  const double variance = (y - design * best).squaredNorm() / (n - 2);
  const double t = statistics::StudentTQuantile(0.975, n - 2);

  ASSERT_EQ(answer.parameters.size(), 2u);
  EXPECT_NEAR(answer.degrees_of_freedom, n - 2, kLinearAlgebra);
  EXPECT_NEAR(answer.residual_scale, std::sqrt(variance), kLinearAlgebra);
  ASSERT_EQ(answer.noise.size(), 1u);
  EXPECT_NEAR(answer.noise[0].sigma, std::sqrt(variance), kLinearAlgebra);
  EXPECT_FALSE(answer.noise[0].known);
  for (int i = 0; i < 2; ++i) {
    const ParameterVerdict& verdict = answer.parameters[static_cast<std::size_t>(i)];
    const double error = std::sqrt(variance * inverse(i, i));
    EXPECT_NEAR(answer.minimum[i], best[i], kLinearAlgebra);
    EXPECT_NEAR(verdict.std_error, error, kLinearAlgebra);
    const double half = t * error;  // white noise, and the tests do not reject it
    EXPECT_EQ(verdict.interval, IntervalKind::kProfile);
    EXPECT_NEAR(verdict.ci95_lower, best[i] - half, kVerdictProfileEnd * half);
    EXPECT_NEAR(verdict.ci95_upper, best[i] + half, kVerdictProfileEnd * half);
    EXPECT_EQ(verdict.verdict, Verdict::kIdentifiable) << ToString(verdict.reason.kind);
    EXPECT_EQ(verdict.remedy.kind, RemedyKind::kNone);
    for (int j = 0; j < 2; ++j) {
      EXPECT_NEAR(answer.covariance(i, j), variance * inverse(i, j), kLinearAlgebra);
    }
  }
  EXPECT_NEAR(answer.correlation(0, 1), inverse(0, 1) / std::sqrt(inverse(0, 0) * inverse(1, 1)),
              kLinearAlgebra);
}

TEST(Uncertainty, StatedNoiseLevelsAreUsed) {
  ToyProblem problem = LineProblem();
  Layout layout = problem.layout();
  layout[0].columns.clear();
  layout[0].sigma = 0.25;
  const ToyProblem stated(problem.parameters(), layout, Line);
  const ToyFit fit(stated);
  const Uncertainty answer = Analyse(fit);
  double s0 = 0;
  double s1 = 0;
  double s2 = 0;
  for (const double t : layout[0].prediction_time) {
    s0 += 1;
    s1 += t;
    s2 += t * t;
  }
  EXPECT_TRUE(std::isinf(answer.degrees_of_freedom));
  EXPECT_TRUE(answer.noise[0].known);
  EXPECT_NEAR(answer.parameters[1].std_error, 0.25 * std::sqrt(s0 / (s0 * s2 - s1 * s1)), kLinearAlgebra);
}

TEST(Uncertainty, ParameterThatNothingDependsOnIsNotIdentifiable) {
  const ToyProblem problem = LineProblem({MakeParameter("friction", 0, 15, 3)});
  const ToyFit fit(problem);
  const Uncertainty answer = Analyse(fit);
  const ParameterVerdict& verdict = answer.parameters[2];
  EXPECT_EQ(verdict.verdict, Verdict::kNotIdentifiable);
  EXPECT_EQ(verdict.interval, IntervalKind::kNone);
  EXPECT_EQ(verdict.reason.kind, ReasonKind::kNoResponse);
  EXPECT_THAT(verdict.reason.channels, ElementsAre("height"));
  EXPECT_EQ(verdict.ci95_lower, 0);
  EXPECT_EQ(verdict.ci95_upper, 15);
  EXPECT_TRUE(std::isinf(verdict.std_error));
  EXPECT_EQ(verdict.remedy.kind, RemedyKind::kNoChannel);
  // The others are what they are without it.
  const ToyProblem without = LineProblem();
  const ToyFit fit_without(without);
  EXPECT_NEAR(answer.parameters[1].std_error, Analyse(fit_without).parameters[1].std_error, kLinearAlgebra);
}

TEST(Uncertainty, ReportsAParameterWithoutEffectAtTheSolutionOnly) {
  // A threshold that the signal does not reach at its start value 2, but would at 0.5.
  ToyProblem problem({MakeParameter("gain", 0, 10, 2), MakeParameter("threshold", 0, 3, 2)},
                     {MakeBlock("one", "height", 30, 1)},
                     [](const Block&, double t, const Vector& p, Vector* gradient) -> Result<double> {
                       const double beyond = std::max(0.0, t - p[1]);
                       if (gradient != nullptr) *gradient << t, (beyond > 0 ? -1 : 0);
                       return p[0] * t + beyond;
                     });
  Random random(3);
  problem.Measure(Values({2, 2}), [&](const Block&, int) { return 0.01 * random.Normal(); });
  const ToyFit fit(problem);
  const ParameterVerdict verdict = Analyse(fit).parameters[1];
  EXPECT_EQ(verdict.verdict, Verdict::kNotIdentifiable);
  EXPECT_EQ(verdict.reason.kind, ReasonKind::kNoResponseHere);
  EXPECT_THAT(verdict.reason.channels, ElementsAre("height"));
}

TEST(Uncertainty, CollinearParametersNameEachOtherAndTheirDirection) {
  ToyProblem problem({MakeParameter("mass", 0, 10, 2), MakeParameter("gravity", 0, 20, 5),
                      MakeParameter("offset", -5, 5, 0)},
                     {MakeBlock("one", "height", 30, 1)},
                     [](const Block&, double t, const Vector& p, Vector* gradient) -> Result<double> {
                       if (gradient != nullptr) *gradient << p[1] * t, p[0] * t, 1;
                       return p[0] * p[1] * t + p[2];
                     });
  Random random(3);
  problem.Measure(Values({2, 5, 1}), [&](const Block&, int) { return 0.01 * random.Normal(); });
  const ToyFit fit(problem);
  const Uncertainty answer = Analyse(fit);
  EXPECT_EQ(answer.parameters[0].verdict, Verdict::kNotIdentifiable);
  EXPECT_EQ(answer.parameters[1].verdict, Verdict::kNotIdentifiable);
  EXPECT_EQ(answer.parameters[2].verdict, Verdict::kIdentifiable)
      << ToString(answer.parameters[2].reason.kind);
  EXPECT_EQ(answer.parameters[0].reason.kind, ReasonKind::kCombination);
  EXPECT_THAT(answer.parameters[0].reason.partners, ElementsAre("gravity"));
  EXPECT_EQ(answer.parameters[1].reason.kind, ReasonKind::kCombination);
  EXPECT_THAT(answer.parameters[1].reason.partners, ElementsAre("mass"));
  const Remedy& remedy = answer.parameters[0].remedy;
  EXPECT_EQ(remedy.kind, RemedyKind::kNoChannel);
  ASSERT_FALSE(remedy.options.empty());
  EXPECT_THAT(remedy.options[0].additions, ElementsAre(AdditionName{AdditionKind::kKnownValue, "gravity"}));
  ASSERT_EQ(answer.directions.size(), 1u);
  EXPECT_TRUE(answer.directions[0].lost);
  const auto& changes = answer.directions[0].changes;
  ASSERT_EQ(changes.size(), 2u);
  EXPECT_EQ(changes[0].parameter, "mass");
  EXPECT_NEAR(changes[0].relative, 0.1, 1e-6);
  EXPECT_EQ(changes[1].parameter, "gravity");
  EXPECT_NEAR(changes[1].relative, -0.1, 1e-6);
  EXPECT_LT(answer.singular_values[2], 1e-7 * answer.singular_values[0]);
  EXPECT_TRUE(std::isfinite(answer.parameters[2].std_error));
}

TEST(Uncertainty, NearlyCollinearParametersHaveWideIntervals) {
  // exp(-t) and 1 - t over a short time differ only in their curvature, which is within the noise.
  ToyProblem problem({MakeParameter("decay", 0, 20, 5), MakeParameter("ramp", 0, 20, 5)},
                     {MakeBlock("one", "height", 40, 0.2)},
                     [](const Block&, double t, const Vector& p, Vector* gradient) -> Result<double> {
                       if (gradient != nullptr) *gradient << std::exp(-t), 1 - t;
                       return p[0] * std::exp(-t) + p[1] * (1 - t);
                     });
  Random random(4);
  problem.Measure(Values({5, 5}), [&](const Block&, int) { return 0.3 * random.Normal(); });
  const ToyFit fit(problem);
  const Uncertainty answer = Analyse(fit);
  for (const ParameterVerdict& verdict : answer.parameters) {
    EXPECT_TRUE(verdict.verdict == Verdict::kWeak || verdict.verdict == Verdict::kNotIdentifiable);
    EXPECT_EQ(verdict.reason.kind, ReasonKind::kCorrelated);
    EXPECT_GT(verdict.reason.std_error, verdict.reason.std_error_without);
  }
  ASSERT_EQ(answer.directions.size(), 1u);
  EXPECT_FALSE(answer.directions[0].lost) << "the residuals change by less than their noise";
  EXPECT_EQ(answer.directions[0].changes.size(), 2u);
}

TEST(Uncertainty, PartnerOnItsBoundIsStillNamed) {
  // With the ramp held on its bound the decay would look well determined; the bound is not known to be true.
  ToyProblem problem({MakeParameter("decay", 0, 20, 5), MakeParameter("ramp", 0, 20, 5)},
                     {MakeBlock("one", "height", 40, 0.2)},
                     [](const Block&, double t, const Vector& p, Vector* gradient) -> Result<double> {
                       if (gradient != nullptr) *gradient << std::exp(-t), 1 - t;
                       return p[0] * std::exp(-t) + p[1] * (1 - t);
                     });
  Random random(8);  // a draw that drives the ramp to its bound
  problem.Measure(Values({5, 5}), [&](const Block&, int) { return 0.3 * random.Normal(); });
  const ToyFit fit(problem);
  const Uncertainty answer = Analyse(fit);
  ASSERT_EQ(answer.parameters[1].verdict, Verdict::kAtBound);
  EXPECT_EQ(answer.parameters[0].verdict, Verdict::kWeak);
  EXPECT_EQ(answer.parameters[0].reason.kind, ReasonKind::kCorrelated);
  EXPECT_THAT(answer.parameters[0].reason.partners, ElementsAre("ramp"));
}

TEST(Uncertainty, TooLittleExcitationIsReported) {
  // Its whole range moves the line by a thousandth; the noise is a tenth.
  ToyProblem problem({MakeParameter("offset", -10, 10, 0), MakeParameter("whisper", 0, 1, 0.5)},
                     {MakeBlock("one", "height", 40, 3)},
                     [](const Block&, double t, const Vector& p, Vector* gradient) -> Result<double> {
                       if (gradient != nullptr) *gradient << 1, 1e-3 * t;
                       return p[0] + 1e-3 * t * p[1];
                     });
  Random random(5);
  problem.Measure(Values({1, 0.5}), [&](const Block&, int) { return 0.1 * random.Normal(); });
  const ToyFit fit(problem);
  const ParameterVerdict verdict = Analyse(fit).parameters[1];
  EXPECT_EQ(verdict.verdict, Verdict::kNotIdentifiable);
  EXPECT_TRUE(verdict.lower_open && verdict.upper_open);
  EXPECT_EQ(verdict.reason.kind, ReasonKind::kWeakExcitation);
}

TEST(Uncertainty, BoundThatIsHitIsNamed) {
  std::vector<Parameter> parameters = {MakeParameter("offset", -10, 10, 0), MakeParameter("slope", 0, 3, 1)};
  ToyProblem problem(parameters, {MakeBlock("one", "height", 40, 3)}, Line);
  Random random(7);
  problem.Measure(Values({1.5, 4}), [&](const Block&, int) { return 0.1 * random.Normal(); });
  const ToyFit fit(problem);
  const Uncertainty answer = Analyse(fit);
  const ParameterVerdict& verdict = answer.parameters[1];
  EXPECT_EQ(verdict.verdict, Verdict::kAtBound);
  EXPECT_EQ(verdict.reason.kind, ReasonKind::kAtBound);
  EXPECT_FALSE(verdict.reason.at_lower);
  EXPECT_EQ(verdict.remedy.kind, RemedyKind::kOtherBound);
  EXPECT_EQ(answer.minimum[1], 3);
  EXPECT_EQ(verdict.ci95_upper, 3);
  EXPECT_TRUE(verdict.upper_open);
  EXPECT_FALSE(verdict.lower_open);
  EXPECT_LT(verdict.ci95_lower, 3);
  EXPECT_TRUE(std::isfinite(verdict.std_error));
  // The offset is fitted as if the slope were known: sigma / sqrt(n).
  EXPECT_NEAR(answer.parameters[0].std_error, answer.noise[0].sigma / std::sqrt(40.0), kLinearAlgebra);
}

TEST(Uncertainty, NuisanceIsProjectedOutAndNotReported) {
  // One slope, and an offset per trial as nuisance.
  const auto formula = [](const Block& block, double t, const Vector& p, Vector* gradient) -> Result<double> {
    const int offset = block.trial == "one" ? 1 : 2;
    if (gradient != nullptr) {
      (*gradient)[0] = t;
      (*gradient)[offset] = 1;
    }
    return p[0] * t + p[offset];
  };
  ToyProblem problem(
      {MakeParameter("slope", 0, 20, 1), MakeParameter("start_one", -5, 5, 0, ParameterKind::kNuisance),
       MakeParameter("start_two", -5, 5, 0, ParameterKind::kNuisance)},
      {MakeBlock("one", "height", 30, 1), MakeBlock("two", "height", 30, 2)}, formula);
  Random random(9);
  problem.Measure(Values({4, 1, -1}), [&](const Block&, int) { return 0.1 * random.Normal(); });
  const ToyFit fit(problem);
  const Uncertainty answer = Analyse(fit);
  ASSERT_EQ(answer.parameters.size(), 1u);
  EXPECT_EQ(answer.covariance.rows(), 1);
  double spread = 0;  // sum of squares of the times about their mean, per trial
  for (const Block& block : problem.layout()) {
    const double mean = 0.5 * block.prediction_time.back();
    for (const double t : block.prediction_time) spread += (t - mean) * (t - mean);
  }
  EXPECT_NEAR(answer.degrees_of_freedom, 57, kLinearAlgebra);
  EXPECT_NEAR(answer.parameters[0].std_error, answer.noise[0].sigma / std::sqrt(spread), kLinearAlgebra);
  EXPECT_EQ(answer.parameters[0].verdict, Verdict::kIdentifiable);
}

TEST(Uncertainty, ParametersThatNuisanceCompensatesAreNotIdentifiable) {
  const auto formula = [](const Block&, double t, const Vector& p, Vector* gradient) -> Result<double> {
    if (gradient != nullptr) *gradient << t, 1, 1;
    return p[0] * t + p[1] + p[2];
  };
  ToyProblem problem({MakeParameter("slope", 0, 20, 1), MakeParameter("level", -5, 5, 0),
                      MakeParameter("start", -5, 5, 0, ParameterKind::kNuisance)},
                     {MakeBlock("one", "height", 30, 1)}, formula);
  Random random(9);
  problem.Measure(Values({4, 1, -1}), [&](const Block&, int) { return 0.1 * random.Normal(); });
  const ToyFit fit(problem);
  const Uncertainty answer = Analyse(fit);
  EXPECT_EQ(answer.parameters[0].verdict, Verdict::kIdentifiable);
  EXPECT_EQ(answer.parameters[1].verdict, Verdict::kNotIdentifiable);
  EXPECT_EQ(answer.parameters[1].reason.kind, ReasonKind::kCompensated);
  EXPECT_THAT(answer.parameters[1].reason.partners, ElementsAre("start"));
}

TEST(Uncertainty, PriorGivesAnIntervalButNoVerdict) {
  Parameter friction = MakeParameter("friction", 0, 15, 3);
  friction.prior = GaussianPrior{3, 0.5};
  const ToyProblem problem = LineProblem({friction});
  const ToyFit fit(problem);
  const ParameterVerdict verdict = Analyse(fit).parameters[2];
  EXPECT_EQ(verdict.verdict, Verdict::kNotIdentifiable);
  EXPECT_NEAR(verdict.std_error, 0.5, kLinearAlgebra);
  EXPECT_TRUE(verdict.reason.by_prior);
}

TEST(Uncertainty, LogarithmicScaleGivesTheSameErrorAsALinearOne) {
  const auto formula = [](const Block&, double t, const Vector& p, Vector* gradient) -> Result<double> {
    if (gradient != nullptr) (*gradient)[0] = t;
    return p[0] * t;
  };
  double error[2];
  for (const bool logarithmic : {false, true}) {
    Parameter stiffness = MakeParameter("stiffness", 1e2, 1e8, 1e5);
    stiffness.scale = logarithmic ? Scale::kLog : Scale::kLinear;
    ToyProblem problem({stiffness}, {MakeBlock("one", "force", 40, 1)}, formula);
    Random random(4);
    problem.Measure(Values({9e5}), [&](const Block&, int) { return 1e4 * random.Normal(); });
    const ToyFit fit(problem);
    const ParameterVerdict verdict = Analyse(fit).parameters[0];
    error[logarithmic ? 1 : 0] = verdict.std_error;
    EXPECT_EQ(verdict.verdict, Verdict::kIdentifiable) << ToString(verdict.reason.kind);
  }
  // The local search on the logarithm stops a millionth of an error away from the minimum.
  EXPECT_NEAR(error[0] / error[1], 1, 1e-5);
}

TEST(Uncertainty, AsManyValuesAsSamplesLeavesNoNoiseToEstimate) {
  const ToyProblem problem = LineProblem({}, 0.1, 2);
  const ToyFit fit(problem);
  const Uncertainty answer = Analyse(fit);
  ASSERT_EQ(answer.parameters.size(), 2u);
  EXPECT_EQ(answer.parameters[0].verdict, Verdict::kNotIdentifiable);
  EXPECT_EQ(answer.parameters[0].reason.kind, ReasonKind::kNoiseLevelUnknown);
  EXPECT_EQ(answer.parameters[0].reason.residuals, 2);
  EXPECT_EQ(answer.parameters[0].reason.fitted, 2);
  EXPECT_EQ(answer.parameters[0].remedy.kind, RemedyKind::kMoreSamples);
}

TEST(Uncertainty, DataWithoutNoiseAreIdentifiableWithoutFalseNotes) {
  const ToyProblem problem = LineProblem({}, 0);
  const ToyFit fit(problem);
  const Result<Uncertainty> answer = AnalyseUncertainty(fit.view, fit.view.Variables(Values({1.5, 4})), {});
  ASSERT_TRUE(answer);
  EXPECT_TRUE(answer->notes.empty()) << ToString(answer->notes.front().kind);
  for (const ParameterVerdict& verdict : answer->parameters) {
    EXPECT_EQ(verdict.verdict, Verdict::kIdentifiable);
    EXPECT_LT(verdict.std_error, 1e-8);
  }
}

TEST(Uncertainty, SolutionThatIsNoMinimumIsReported) {
  const ToyProblem problem = LineProblem();
  const ToyFit fit(problem);
  const Uncertainty answer = Analyse(fit);  // from the start, which is far off
  ASSERT_EQ(answer.notes.size(), 1u);
  EXPECT_EQ(answer.notes[0].kind, WarningKind::kNotAMinimum);
  ASSERT_EQ(answer.notes[0].numbers.size(), 2u);
  EXPECT_GT(answer.notes[0].numbers[0], answer.notes[0].numbers[1]) << "the cost fell";
  const Result<Uncertainty> again = AnalyseUncertainty(fit.view, fit.view.Variables(answer.minimum), {});
  ASSERT_TRUE(again);
  EXPECT_TRUE(again->notes.empty());
  EXPECT_EQ(again->parameters[1].value, answer.minimum[1]);
}

TEST(Uncertainty, FailuresAreValues) {
  const ToyProblem problem = LineProblem();
  const ToyFit fit(problem);
  const Result<Uncertainty> short_x = AnalyseUncertainty(fit.view, Values({0.5}), {});
  ASSERT_FALSE(short_x);
  EXPECT_THAT(short_x.error().message, HasSubstr("1 variables, expected 2"));

  const ToyProblem broken({MakeParameter("a", 0, 1, 0.5)}, {MakeBlock("one", "height", 5, 1)},
                          [](const Block&, double t, const Vector&, Vector*) -> Result<double> {
                            return Fail("force not finite at t = {}", t);
                          });
  const ToyFit broken_fit(broken);
  const Result<Uncertainty> failed = AnalyseUncertainty(broken_fit.view, Values({0.5}), {});
  ASSERT_FALSE(failed);
  EXPECT_EQ(failed.error().message, "the solution cannot be analysed: force not finite at t = 0");
}

TEST(Uncertainty, ActiveConstraintIsRespectedAndReported) {
  // slope <= 3 + offset / 10 by a constraint: the free minimum (1.5, 4) violates it.
  Constraint steep{"not_too_steep", Values({-0.1, 1}), -3};
  std::vector<Parameter> parameters = {MakeParameter("offset", -10, 10, 0), MakeParameter("slope", 0, 20, 1)};
  ToyProblem problem(parameters, {MakeBlock("one", "height", 40, 3)}, Line, {steep});
  Random random(7);
  problem.Measure(Values({1.5, 4}), [&](const Block&, int) { return 0.1 * random.Normal(); });
  const ToyFit fit(problem);
  const Uncertainty answer = Analyse(fit);
  // The penalty allows a violation of about one over its factor of 1e4.
  EXPECT_NEAR(answer.minimum[1] - 0.1 * answer.minimum[0], 3, 5e-3);
  EXPECT_EQ(answer.notes.back().kind, WarningKind::kActiveConstraint);
  EXPECT_THAT(answer.notes.back().names, ElementsAre("not_too_steep"));
}

}  // namespace
}  // namespace sinew
