// Named causes against free terms, with residuals whose projections are worked out by hand.
#include "identify/diagnosis/select/free_terms.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <vector>

#include "base/random.h"
#include "identify/diagnosis/diagnosis.h"

namespace sinew::diagnosis {
namespace {

/// y = level + swing (1, -1, -1, 1, 1, -1, -1, ...: orthogonal to all else here) + effects, one trial of n
/// samples at t = 0, 1, ... with n a multiple of 8. Effects: sign (1 in the first half, -1 in the
/// second), slope (t from the middle). A signal that is constant.
class Samples final : public Problem {
 public:
  explicit Samples(std::vector<double> measured) {
    for (const char* name : {"level", "sign_size", "slope_size", "swing"}) {
      Parameter p;
      p.name = name;
      p.unit = "1";
      p.meaning = name;
      p.lower = -100;
      p.upper = 100;
      parameters_.push_back(p);
    }
    for (const int i : {1, 2}) {
      Parameter& p = parameters_[static_cast<std::size_t>(i)];
      p.kind = ParameterKind::kEffect;
      p.effect = i == 1 ? "sign" : "slope";
      effects_.push_back({p.effect, Level::kSensor, p.effect, "", {i}});
    }
    Block block;
    block.trial = "one";
    block.channel = "y";
    block.unit = "1";
    block.columns = {0, 1, 2, 3};
    for (int i = 0; i < static_cast<int>(measured.size()); ++i) {
      block.prediction_time.push_back(i);
      block.sample.push_back(i);
    }
    block.measured = std::move(measured);
    layout_.push_back(block);
  }

  static double Column(int parameter, int i, int n = 8) {
    if (parameter == 0) return 1;
    if (parameter == 3) return i % 4 == 0 || i % 4 == 3 ? 1 : -1;
    return parameter == 1 ? (2 * i < n ? 1 : -1) : i - 0.5 * (n - 1);
  }

  [[nodiscard]] const std::vector<Parameter>& parameters() const override { return parameters_; }
  [[nodiscard]] const Layout& layout() const override { return layout_; }
  [[nodiscard]] const std::vector<Effect>& effects() const override { return effects_; }
  [[nodiscard]] std::vector<Signal> ResidualCovariates(int /*block*/) const override {
    return {{"constant", "1", std::vector<double>(layout_[0].measured.size(), 2.0)}};
  }
  Status Predict(const Query& query, Workspace& /*workspace*/, Prediction& prediction) const override {
    const int n = layout_[0].samples();
    for (int i = 0; i < n; ++i) {
      double y = 0;
      for (int p = 0; p < 4; ++p) {
        y += query.parameters[p] * Column(p, i, n);
        if (query.Differentiates(p)) prediction.derivatives(0)(i, p) = Column(p, i, n);
      }
      prediction.values(0)[i] = y;
    }
    return {};
  }

 private:
  std::vector<Parameter> parameters_;
  std::vector<Effect> effects_;
  Layout layout_;
};

noise::NoiseModel UnitNoise() {
  noise::NoiseModel noise;
  noise.channels = {{}};
  noise.channels[0].channel = "y";
  noise.channel_of = {0};
  return noise;
}

/// The model with these candidates at the given values, whether they are the best or not.
ScoredModel ModelAt(const Samples& problem, const std::vector<Candidate>& candidates,
                    std::vector<int> released, const Vector& point) {
  ScoredModel model;
  auto setup = std::make_shared<FitSetup>(MakeFitSetup(problem, {}).value());
  for (const int c : released) setup->free.push_back(candidates[static_cast<std::size_t>(c)].parameters[0]);
  std::sort(setup->free.begin(), setup->free.end());
  setup->rest = point;
  model.refit.released = std::move(released);
  model.refit.setup = setup;
  model.refit.point = point;
  model.refit.noise = UnitNoise();
  model.noise = UnitNoise();
  const LeastSquares fit(problem, *setup);
  model.refit.x = fit.Variables(point);
  const noise::Whitening whitening(model.noise, TrainStretches(fit));
  model.design = MakeDesign(fit, model.refit.x, candidates, whitening).value();
  model.whitened = MakeScores(fit, model.design, candidates, &whitening);
  return model;
}

FreeTermComparison Compare(const std::vector<double>& measured, double sign) {
  const Samples problem(measured);
  std::vector<Candidate> candidates = ListCandidates(problem, MakeFitSetup(problem, {}).value());
  Vector null = Vector::Zero(4);
  Vector fitted = null;
  fitted[1] = sign;
  const ScoredModel base = ModelAt(problem, candidates, {}, null);
  const ScoredModel extended = ModelAt(problem, candidates, {0}, fitted);
  return CompareWithFreeTerms(problem, candidates, base, extended, {0}).value();
}

TEST(FreeTerms, PricesGrowWithParametersAndWithTheChoice) {
  EXPECT_DOUBLE_EQ(PriceOf(1, 1, 1), 4);
  EXPECT_DOUBLE_EQ(PriceOf(3, 2, 10), 12 + 4 * std::log(10.0));
  EXPECT_DOUBLE_EQ(PriceOf(0, 0, 0), 0);
}

TEST(FreeTerms, TheCauseItselfIsBetterThanAnyFreeTerm) {
  // 10 times the sign: it explains 8 * 10^2 = 800. The slope of the level in time explains
  // (10 sum |i - 3.5|)^2 / sum (i - 3.5)^2 = (10 * 16)^2 / 42 = 609.5.
  std::vector<double> measured;
  for (int i = 0; i < 8; ++i) measured.push_back(10 * Samples::Column(1, i));
  const FreeTermComparison found = Compare(measured, 10);
  EXPECT_NEAR(found.named, 800, 1e-6);
  EXPECT_NEAR(found.price, 4 + 2 * std::log(2.0), 1e-12);  // one parameter, one of two known candidates
  // A curve with a knot for every sample could explain all 800, but at 7 degrees of freedom.
  EXPECT_LE(found.best.explained, 800 + 1e-6);
  EXPECT_FALSE(found.FreeTermIsBetter());
}

TEST(FreeTerms, ACauseThatOnlyResemblesTheErrorIsWorse) {
  // A slope of the level in time, 10 (i - 3.5): squared length 10^2 * 42 = 4200. The sign explains
  // (10 * 16)^2 / 8 = 3200, the parameter's own drift all of it, with one parameter each.
  std::vector<double> measured;
  for (int i = 0; i < 8; ++i) measured.push_back(10 * Samples::Column(2, i));
  const FreeTermComparison found = Compare(measured, 20);
  EXPECT_NEAR(found.named, 3200, 1e-6);
  EXPECT_EQ(found.best.name, "level(time)");
  EXPECT_EQ(found.best.degrees, 1);
  EXPECT_NEAR(found.best.explained, 4200, 1e-6);
  EXPECT_TRUE(found.FreeTermIsBetter());
}

TEST(FreeTerms, ASmallAdvantageDoesNotPayForFreedom) {
  // The sign, and 1 in the first sample alone with -1 in the fourth, which is orthogonal to the level, the
  // sign and nearly to a slope: a curve explains 8 * 10^2 + 2, the cause 800. Two units do not pay for six
  // more parameters.
  std::vector<double> measured;
  for (int i = 0; i < 8; ++i) measured.push_back(10 * Samples::Column(1, i));
  measured[0] += 1;
  measured[3] -= 1;
  const FreeTermComparison found = Compare(measured, 10);
  EXPECT_NEAR(found.named, 800, 1e-6);
  EXPECT_FALSE(found.FreeTermIsBetter());
}

TEST(FreeTerms, TheRefitCountsWhereTheLinearisationExplainsLess) {
  // The extended model is given with the wrong value, 5 instead of 10: its refit would explain nothing more
  // than the projection off its own columns, which is the same 800.
  std::vector<double> measured;
  for (int i = 0; i < 8; ++i) measured.push_back(10 * Samples::Column(1, i));
  EXPECT_NEAR(Compare(measured, 5).named, 800, 1e-6);
}

// The whole diagnosis. A slope, with only the sign in the library (the other effect is held at its null). The
// sign explains 3/4 of the statistic of the slope, which is 25 in the mean.
TEST(FreeTerms, AnErrorOutsideTheLibraryIsNotPutDownToWhatResemblesIt) {
  constexpr int kCount = 400;
  const double slope = 5 / std::sqrt(kCount * (kCount * kCount - 1.0) / 12);  // sum of squares of the times
  int better = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    Random random(seed);
    std::vector<double> measured;
    for (int i = 0; i < kCount; ++i)
      measured.push_back(slope * Samples::Column(2, i, kCount) + 3 * Samples::Column(3, i) + random.Normal());
    const Samples problem(measured);
    FitRequest request;
    request.fix = {{"slope_size", 0}};
    const auto d = Diagnose(problem, MakeFitSetup(problem, request).value(), {});
    ASSERT_TRUE(d) << d.error().message;
    for (const Warning& warning : d->warnings) {
      if (warning.kind != WarningKind::kFreeTermExplainsMore) continue;
      ++better;
      EXPECT_EQ(d->verdict, DiagnosisVerdict::kUnexplained);
      ASSERT_EQ(d->causes.size(), 1u);  // it is still said what the error resembles
      EXPECT_EQ(d->causes[0].effect, "sign");
      EXPECT_EQ(warning.names[0], "level(time)");
      EXPECT_GT(warning.numbers[0], warning.numbers[1]);
    }
  }
  std::printf("a free term is better in %d of 40\n", better);
  EXPECT_GE(better, 10);
}

}  // namespace
}  // namespace sinew::diagnosis
