// What is found where no effect of the library explains the error: a curve, a drift or a line that the test
// has put into the data.
#include "identify/diagnosis/discover/discovery.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "base/constants.h"
#include "tests/identify/diagnosis/linear_laws.h"

namespace sinew::diagnosis {
namespace {

constexpr double kNoise = 0.1;
constexpr double kPValue = 0.001;  // given as the result of the selection

/// A diagnosis after a selection that found no cause, and what is then discovered.
class DiscoveryCase {
 public:
  /// @param unknown effects of the candidates that the selection would leave as significant, in this order
  DiscoveryCase(const LinearLaws& laws, const std::vector<std::string>& unknown, bool line_left = false)
      : problem(laws), state(laws, options) {
    const FitSetup setup = MakeFitSetup(laws, {}).value();
    state.candidates = ListCandidates(laws, setup);
    state.refitter = std::make_unique<Refitter>(laws, setup, state.candidates);
    state.selection.model = state.refitter->Fit({}, {setup.rest});
    EXPECT_EQ(state.selection.model.failure, "");
    state.base.refit = state.selection.model;
    state.selection.line_left = line_left;
    for (const std::string& effect : unknown) {
      const auto at = std::find_if(state.candidates.begin(), state.candidates.end(),
                                   [&](const Candidate& candidate) { return candidate.effect == effect; });
      EXPECT_NE(at, state.candidates.end()) << effect;
      state.selection.unknown.push_back(static_cast<int>(at - state.candidates.begin()));
      state.selection.unknown_p_value.push_back(kPValue);
    }
    found.extended_point = state.selection.model.point;
    const Status status = DiscoverUnknown(state, found);
    EXPECT_TRUE(status) << status.error().message;
  }

  [[nodiscard]] bool PointIsThatOfTheBaseModel() const {
    return found.extended_point == state.selection.model.point;
  }
  /// Root mean square of the residuals with the added term [the unit of y].
  [[nodiscard]] double AddedRms(BlockRole role) const {
    double squares = 0;
    double count = 0;
    for (const auto& [b, residual] : state.added) {
      if (problem.layout()[static_cast<std::size_t>(b)].role != role) continue;
      squares += residual.squaredNorm();
      count += static_cast<double>(residual.size());
    }
    return std::sqrt(squares / count);
  }

  const LinearLaws& problem;
  DiagnosisOptions options;
  DiagnosisState state;
  Diagnosis found;
};

LinearLaws::Truth Nothing() {
  LinearLaws::Truth truth;
  truth.noise = kNoise;
  return truth;
}

/// size u^2 as a curve of y(u): even, so that neither gain nor rate can stand in for it.
LinearLaws::Truth Parabola(double size) {
  LinearLaws::Truth truth = Nothing();
  for (int k = 0; k < truth.knots; ++k) {
    const double knot = -2.5 + 5.0 * k / (truth.knots - 1);
    truth.effects.emplace_back("y(u)[" + std::to_string(k) + "]", size * knot * knot);
  }
  return truth;
}

/// A curve of y(time): `slope` times the time, which gain and rate cannot describe.
LinearLaws::Truth Ramp(double slope) {
  LinearLaws::Truth truth = Nothing();
  for (int k = 0; k < truth.knots; ++k)
    truth.effects.emplace_back("y(time)[" + std::to_string(k) + "]", slope * 10 * k / (truth.knots - 1));
  return truth;
}

/// Expects one curve, `truth` at its knots, and that held-out trials have an error of `before` without it.
void ExpectCurve(const DiscoveryCase& one, const std::string& signal, ShapeKind shape,
                 const std::function<double(double)>& truth, double before) {
  ASSERT_EQ(one.found.unknown_terms.size(), 1U);
  const UnknownFinding& found = one.found.unknown_terms[0];
  EXPECT_EQ(found.kind, UnknownKind::kCurve);
  EXPECT_EQ(found.name, "y(" + signal + ")");
  EXPECT_EQ(found.port, "y");
  EXPECT_EQ(found.unit, "1");
  EXPECT_EQ(found.signal, signal);
  EXPECT_EQ(found.p_value, kPValue);
  EXPECT_EQ(found.shape.kind, shape) << ToString(found.shape.kind);
  EXPECT_TRUE(found.shape.simple());
  ASSERT_EQ(found.knots.size(), 8U);
  ASSERT_EQ(found.curve.size(), 8U);
  ASSERT_EQ(found.deviation.size(), 8U);
  for (std::size_t k = 0; k < 8; ++k) {
    EXPECT_GT(found.deviation[k], 0);
    // Four standard deviations at each of eight knots: once in 2000 cases.
    EXPECT_NEAR(found.curve[k], truth(found.knots[k]), 4 * found.deviation[k]) << k;
  }
  // 1000 samples with a noise of 0.1 that share 8 values: about 0.01 each, at the outer knots more.
  EXPECT_LT(found.deviation[3], 0.03);
  // Ten seconds are not whole periods of u: the mean square of a curve differs by some tenths of itself.
  EXPECT_NEAR(found.held_out_reduction, 1 - kNoise / before, 0.08);
}

// The mean of u^4 for u = 1.3 sin + 0.9 sin is 3 / 8 (1.3^4 + 0.9^4) + 3 / 2 1.3^2 0.9^2 = 3.370. A score of
// about 1000 * 0.05^2 * 3.37 / 0.01 = 840: one linear step is enough.
TEST(Discovery, FindsAHiddenCurveToFirstOrder) {
  const LinearLaws problem(Parabola(0.05), 3);
  const DiscoveryCase one(problem, {"y(u)"});
  ExpectCurve(
      one, "u", ShapeKind::kQuadraticEven, [](double u) { return 0.05 * u * u; },
      std::sqrt(kNoise * kNoise + 0.05 * 0.05 * 3.370));
  EXPECT_TRUE(one.PointIsThatOfTheBaseModel());
  ASSERT_EQ(one.state.added.size(), 6U) << "all trials";
  // 1000 and 500 samples: four deviations of a root mean square of noise, 1 / sqrt(2 * 500) each.
  EXPECT_NEAR(one.AddedRms(BlockRole::kTrain), kNoise, 0.13 * kNoise);
  EXPECT_NEAR(one.AddedRms(BlockRole::kValidate), kNoise, 0.13 * kNoise);
}

// The mean of t^2 over 10 s is 100 / 3. A score of about 1000 * 0.1^2 * 33 / 0.01 = 33000: the curve is
// fitted with all other parameters.
TEST(Discovery, RefitsALargeHiddenCurve) {
  const LinearLaws problem(Ramp(0.1), 3);
  const DiscoveryCase one(problem, {"y(time)"});
  ExpectCurve(
      one, "time", ShapeKind::kLinear, [](double t) { return 0.1 * t; },
      std::sqrt(kNoise * kNoise + 0.1 * 0.1 * 100 / 3));
  EXPECT_TRUE(one.state.added.empty()) << "parameters of the extended model describe it";
  const int first = problem.Index("y(time)[0]");
  for (int k = 0; k < 8; ++k) {
    EXPECT_EQ(one.found.extended_point[first + k],
              one.found.unknown_terms[0].curve[static_cast<std::size_t>(k)]);
  }
}

// y(u) contains the straight line, which the gain describes too: a change of the gain and the opposite line
// cancel. What the data determine is the curve for a given gain.
TEST(Discovery, StandardErrorsOfALargeCurveAreThoseForGivenBaseParameters) {
  const LinearLaws problem(Parabola(0.5), 3);
  const DiscoveryCase one(problem, {"y(u)"});
  ASSERT_EQ(one.found.unknown_terms.size(), 1U);
  const UnknownFinding& found = one.found.unknown_terms[0];
  EXPECT_EQ(found.shape.kind, ShapeKind::kQuadraticEven) << ToString(found.shape.kind);
  EXPECT_EQ(found.inseparable_from, std::vector<std::string>{"gain"});
  const double gain = one.found.extended_point[problem.Index("gain")];
  for (std::size_t k = 0; k < 8; ++k) {
    // 1000 samples with a noise of 0.1; the outer knots lie beyond nearly all of them.
    EXPECT_GT(found.deviation[k], 0) << k;
    EXPECT_LT(found.deviation[k], 0.2) << k;
    const double u = found.knots[k];
    EXPECT_NEAR(found.curve[k], 0.5 * u * u + (2 - gain) * u, 4 * found.deviation[k]) << k;
  }
}

// In held-out trials the curve is there with the opposite sign: with it they become worse.
TEST(Discovery, CurveThatMakesHeldOutTrialsWorseIsLeftOut) {
  for (const double size : {0.05, 0.3}) {
    LinearLaws::Truth truth = Parabola(size);
    truth.held_out_share = -1;
    const LinearLaws problem(truth, 3);
    const DiscoveryCase one(problem, {"y(u)"});
    EXPECT_TRUE(one.found.unknown_terms.empty()) << size;
    EXPECT_TRUE(one.state.added.empty()) << size;
    EXPECT_TRUE(one.PointIsThatOfTheBaseModel()) << size;
  }
}

TEST(Discovery, FindsADriftOfAParameter) {
  LinearLaws::Truth truth = Nothing();
  truth.gain_change = 0.2;
  const LinearLaws problem(truth, 3);
  const DiscoveryCase one(problem, {"gain(time)"});
  ASSERT_EQ(one.found.unknown_terms.size(), 1U);
  const UnknownFinding& found = one.found.unknown_terms[0];
  EXPECT_EQ(found.kind, UnknownKind::kDrift);
  EXPECT_EQ(found.name, "gain(time)");
  EXPECT_EQ(found.port, "gain");
  EXPECT_EQ(found.signal, "time");
  EXPECT_EQ(found.signal_unit, "s");
  EXPECT_EQ(found.shape.kind, ShapeKind::kNone);
  // 250 samples at 0.04 s.
  EXPECT_EQ(found.knots, (std::vector<double>{0, 249 * 0.04}));
  // 1000 samples of a signal of variance 1.25: 0.005 for the change, 0.003 for the gain; four of them.
  constexpr double kWithin = 0.025;
  ASSERT_EQ(found.curve.size(), 2U);
  EXPECT_NEAR(found.curve[0], 1.8, kWithin);
  EXPECT_NEAR(found.curve[1], 2.2, kWithin);
  // The 0.005 holds if u^2 and the time are independent, which they are not quite.
  EXPECT_NEAR(found.deviation[0], 0.005, 0.001);
  EXPECT_GT(found.held_out_reduction, 0);
  EXPECT_TRUE(one.PointIsThatOfTheBaseModel());
  EXPECT_EQ(one.state.added.size(), 6U);
}

// One of the examined frequencies, multiples of half of 1 / duration.
constexpr double kHum = 100 * 0.5 / (249 * 0.04);

TEST(Discovery, FindsALineInTheSpectrum) {
  LinearLaws::Truth truth = Nothing();
  truth.hum = 0.2;
  truth.hum_frequency = kHum;
  const LinearLaws problem(truth, 3);
  const DiscoveryCase one(problem, {}, true);
  ASSERT_EQ(one.found.unknown_terms.size(), 1U);
  const UnknownFinding& found = one.found.unknown_terms[0];
  EXPECT_EQ(found.kind, UnknownKind::kPeriodic);
  EXPECT_EQ(found.name, "y(period)");
  EXPECT_EQ(found.port, "y");
  EXPECT_EQ(found.signal, "time");
  EXPECT_NEAR(found.frequency, kHum, 1e-9);
  EXPECT_LT(found.p_value, 1e-6);
  ASSERT_EQ(found.curve.size(), 17U);
  for (std::size_t i = 0; i < 17; ++i) {
    const double turn = static_cast<double>(i) / 16;
    EXPECT_NEAR(found.knots[i], turn / kHum, 1e-9);
    // Either amplitude has a standard deviation of 0.1 sqrt(2 / 1000) = 0.0045; four of them.
    EXPECT_NEAR(found.curve[i], 0.2 * std::sin(2 * kPi * turn + 1), 0.018) << "measured minus predicted";
    EXPECT_TRUE(std::isnan(found.deviation[i]));
  }
  // 1 - 0.1 / sqrt(0.01 + 0.2^2 / 2); 500 samples: 0.03 of a root mean square, three of them of 0.58.
  EXPECT_NEAR(found.held_out_reduction, 1 - 1 / std::sqrt(3.0), 0.055);
  EXPECT_EQ(one.state.added.size(), 6U);
  EXPECT_NEAR(one.AddedRms(BlockRole::kTrain), kNoise, 0.13 * kNoise);
  EXPECT_NEAR(one.AddedRms(BlockRole::kValidate), kNoise, 0.13 * kNoise);
  ASSERT_EQ(one.found.scores.size(), 1U) << "it is listed with the effects";
  EXPECT_EQ(one.found.scores[0].effect, "y(period)");
  EXPECT_FALSE(one.found.scores[0].known);
  EXPECT_EQ(one.found.scores[0].degrees, 2);
}

TEST(Discovery, LineThatTheSelectionDidNotLeaveIsNotAdded) {
  LinearLaws::Truth truth = Nothing();
  truth.hum = 0.2;
  truth.hum_frequency = kHum;
  const LinearLaws problem(truth, 3);
  const DiscoveryCase one(problem, {}, false);
  EXPECT_TRUE(one.found.unknown_terms.empty());
}

TEST(Discovery, FindsNothingInDataWithoutAHiddenError) {
  const LinearLaws problem(Nothing(), 3);
  const auto setup = MakeFitSetup(problem, {});
  ASSERT_TRUE(setup);
  const auto diagnosis = Diagnose(problem, *setup, {});
  ASSERT_TRUE(diagnosis) << diagnosis.error().message;
  EXPECT_EQ(diagnosis->verdict, DiagnosisVerdict::kAdequate) << "false alarms: 5 % of all seeds";
  EXPECT_TRUE(diagnosis->unknown_terms.empty());
  EXPECT_EQ(diagnosis->extended_point, diagnosis->base_point);
}

// Without held-out trials nothing can be rejected: of four terms the first three are reported in their order,
// and the first of them extends the model.
TEST(Discovery, ReportsThreeTermsAtMostAndAddsTheFirst) {
  LinearLaws::Truth truth = Parabola(0.05);
  truth.gain_change = 0.2;
  const LinearLaws problem(truth, 3, 4, 0);
  const DiscoveryCase one(problem, {"gain(time)", "y(u)", "rate(time)", "y(time)"});
  ASSERT_EQ(one.found.unknown_terms.size(), 3U);
  EXPECT_EQ(one.found.unknown_terms[0].name, "gain(time)");
  EXPECT_EQ(one.found.unknown_terms[1].name, "y(u)");
  EXPECT_EQ(one.found.unknown_terms[2].name, "rate(time)");
  for (const UnknownFinding& found : one.found.unknown_terms) EXPECT_EQ(found.held_out_reduction, 0);
  EXPECT_EQ(one.state.added.size(), 4U);
  // The drift is removed and the curve is left: sqrt(0.01 + 0.05^2 * 3.37) = 0.136, with the tolerance above
  // for the mean of u^4.
  EXPECT_NEAR(one.AddedRms(BlockRole::kTrain), 0.136, 0.012);
}

}  // namespace
}  // namespace sinew::diagnosis
