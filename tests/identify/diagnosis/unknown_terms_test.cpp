// Unknown terms beside the causes that cross-validation has chosen.
#include "identify/diagnosis/select/unknown_terms.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "tests/identify/diagnosis/linear_laws.h"

namespace sinew::diagnosis {
namespace {

// A law of u that no effect is, 30 times the noise, beside a drift.
LinearLaws::Truth OutsideTheLibrary() {
  LinearLaws::Truth truth;
  truth.noise = 0.01;
  truth.effects = {{"drift_size", 0.3}};
  truth.unknown = 0.3;
  truth.knots = 16;
  return truth;
}

std::vector<std::string> Names(const std::vector<Cause>& causes) {
  std::vector<std::string> names;
  for (const Cause& cause : causes) names.push_back(cause.effect);
  return names;
}

Result<Diagnosis> DiagnosisOf(const LinearLaws& problem, int threads = 1) {
  SINEW_ASSIGN(const FitSetup setup, MakeFitSetup(problem, {}));
  DiagnosisOptions options;
  options.threads = threads;
  return Diagnose(problem, setup, options);
}

TEST(UnknownTerms, OnlyTheCauseIsNamedAndTheRestIsDescribed) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const LinearLaws problem(OutsideTheLibrary(), seed, 6, 2, 200);
    const auto d = DiagnosisOf(problem);
    ASSERT_TRUE(d) << d.error().message;
    EXPECT_EQ(d->verdict, DiagnosisVerdict::kUnexplained) << seed;
    EXPECT_FALSE(d->left_out.empty()) << seed;
    EXPECT_EQ(Names(d->causes), std::vector<std::string>{"drift"}) << seed;
    ASSERT_EQ(d->unknown_terms.size(), 1U) << seed;
    const UnknownFinding& term = d->unknown_terms.front();
    EXPECT_EQ(term.name, "y(u)") << seed;
    EXPECT_TRUE(std::isnan(term.p_value)) << seed;
    EXPECT_GT(term.held_out_reduction, 0.5) << seed;
    // The curve is the law, up to what gain and a constant can do as well.
    ASSERT_EQ(term.curve.size(), 16U);
    for (const double deviation : term.deviation) EXPECT_TRUE(std::isnan(deviation) || deviation > 0) << seed;
    for (const DiagnosedParameter& p : d->extended_parameters)
      EXPECT_EQ(p.name.find('('), std::string::npos) << p.name;
    for (const WithdrawnCause& cause : d->withdrawn)
      EXPECT_EQ(cause.terms, std::vector<std::string>{"y(u)"}) << cause.effect;
  }
}

// A term that takes part in no test is found beside the causes all the same.
TEST(UnknownTerms, OneThatIsOnlyFittedBesideCauses) {
  LinearLaws::Truth truth = OutsideTheLibrary();
  truth.beside_causes = true;
  const auto d = DiagnosisOf(LinearLaws(truth, 1, 6, 2, 200));
  ASSERT_TRUE(d) << d.error().message;
  EXPECT_EQ(Names(d->causes), std::vector<std::string>{"drift"});
  ASSERT_EQ(d->unknown_terms.size(), 1U);
  EXPECT_EQ(d->unknown_terms.front().name, "y(u)");
  const auto is_term = [](const EffectScore& score) { return score.effect.rfind("y(", 0) == 0; };
  EXPECT_TRUE(std::none_of(d->scores.begin(), d->scores.end(), is_term));
}

TEST(UnknownTerms, NoneWhereTheCausesExplainAll) {
  LinearLaws::Truth truth = OutsideTheLibrary();
  truth.unknown = 0;
  truth.effects.emplace_back("quadratic_size", 0.2);
  const auto d = DiagnosisOf(LinearLaws(truth, 1, 6, 2, 200));
  ASSERT_TRUE(d) << d.error().message;
  EXPECT_TRUE(d->unknown_terms.empty());
  std::vector<std::string> names = Names(d->causes);
  std::sort(names.begin(), names.end());
  EXPECT_EQ(names, (std::vector<std::string>{"drift", "quadratic"}));
}

// An error that differs from trial to trial is no function of a signal: left-out data do not need a term.
TEST(UnknownTerms, NoneForWhatDiffersBetweenTrials) {
  LinearLaws::Truth truth = OutsideTheLibrary();
  truth.unknown = 0;
  truth.slow_error = 0.3;
  const auto d = DiagnosisOf(LinearLaws(truth, 1, 6, 2, 200));
  ASSERT_TRUE(d) << d.error().message;
  EXPECT_FALSE(d->left_out.empty());
  EXPECT_TRUE(d->unknown_terms.empty());
}

TEST(UnknownTerms, TheNumberOfThreadsChangesNoBit) {
  const LinearLaws problem(OutsideTheLibrary(), 4, 6, 2, 200);
  const auto one = DiagnosisOf(problem, 1);
  const auto two = DiagnosisOf(problem, 2);
  ASSERT_TRUE(one && two);
  ASSERT_EQ(one->unknown_terms.size(), two->unknown_terms.size());
  for (std::size_t i = 0; i < one->unknown_terms.size(); ++i)
    EXPECT_EQ(one->unknown_terms[i].curve, two->unknown_terms[i].curve);
  EXPECT_EQ(Names(one->causes), Names(two->causes));
}

TEST(UnknownTerms, WeightsOfTermsAloneArePulledToZero) {
  const LinearLaws problem(OutsideTheLibrary(), 1);
  const auto setup = MakeFitSetup(problem, {});
  ASSERT_TRUE(setup);
  const auto candidates = ListCandidates(problem, *setup);
  const FitSetup shrunk = WithShrunkTerms(*setup, candidates, 10);
  for (const Candidate& candidate : candidates) {
    double cost = 0;
    for (const int index : candidate.parameters) {
      const Parameter& p = shrunk.parameters[static_cast<std::size_t>(index)];
      EXPECT_EQ(p.prior.has_value(), !candidate.known) << candidate.effect;
      if (p.prior) cost += std::pow(p.upper / 3 / p.prior->standard_deviation, 2);
    }
    // A third of the range, at every knot: 1e-4 of the squared residual.
    if (!candidate.known && !candidate.parameters.empty()) {
      EXPECT_NEAR(cost, 1e-2, 1e-12);
    }
  }
}

}  // namespace
}  // namespace sinew::diagnosis
