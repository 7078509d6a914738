#include "identify/differenced_problem.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "identify/check_problem.h"
#include "identify/identification/identification.h"
#include "tests/identify/support/error_of.h"

namespace sinew {
namespace {

using testing::HasSubstr;

/// y = a exp(b t) + kink max(0, c), as a simulator would give it.
class Simulator final : public DifferencedProblem {
 public:
  explicit Simulator(double noise = 0) : noise_(noise) {
    parameters_ = {BaseParameter("a", "m", "", -3, 3, 1), BaseParameter("b", "1/s", "", -2, 0, -1),
                   BaseParameter("large", "1", "does nothing", 1e5, 2e5, 1.5e5),
                   EffectParameter("c", "m", "", 0, 1, 0, "kink")};
    Parameter log = BaseParameter("tiny", "m", "added", 1e-6, 1e-2, 1e-4);
    log.scale = Scale::kLog;
    parameters_.push_back(log);
    parameters_[3].null_step = 0.25;
    Block block;
    block.trial = "run";
    block.channel = "y";
    block.unit = "m";
    for (int i = 0; i < 20; ++i) {
      block.prediction_time.push_back(0.1 * i);
      block.sample.push_back(i);
      block.measured.push_back(2 * std::exp(-0.05 * i));
    }
    block.columns = {0, 1, 2, 3, 4};
    layout_.push_back(block);
  }
  [[nodiscard]] const std::vector<Parameter>& parameters() const override { return parameters_; }
  [[nodiscard]] const Layout& layout() const override { return layout_; }
  [[nodiscard]] double accuracy() const override { return noise_ > 0 ? noise_ : 2e-16; }

  double fails_below = -100;  ///< of b

 private:
  Status PredictValues(const Vector& p, const std::vector<bool>& blocks, Workspace& /*workspace*/,
                       Prediction& prediction) const override {
    if (!blocks[0]) return {};
    for (int i = 0; i < p.size(); ++i) {
      const Parameter& of = parameters_[static_cast<std::size_t>(i)];
      if (p[i] < of.lower || p[i] > of.upper) throw std::logic_error(of.name + " left its bounds");
    }
    if (p[1] < fails_below) return Fail("it did not settle");
    for (int i = 0; i < 20; ++i) {
      const double t = layout_[0].prediction_time[static_cast<std::size_t>(i)];
      const double jump = p[3] >= 0.2 ? 1 : 0;  // nothing at all near the null
      const double exact = p[0] * std::exp(p[1] * t) + jump + p[4];
      prediction.values(0)[i] = noise_ > 0 ? noise_ * std::round(exact / noise_) : exact;
    }
    return {};
  }

  double noise_;
  std::vector<Parameter> parameters_;
  Layout layout_;
};

Prediction Predict(const Problem& problem, const Vector& point) {
  Prediction prediction(problem.layout());
  prediction.Poison();
  const auto workspace = problem.NewWorkspace();
  const std::vector<bool> all(problem.layout().size(), true);
  EXPECT_EQ(ErrorOf(problem.Predict({point, all, true, nullptr}, *workspace, prediction)), "");
  return prediction;
}

double WorstError(const Simulator& simulator, const Vector& p) {
  const Prediction prediction = Predict(simulator, p);
  double worst = 0;
  for (int i = 0; i < 20; ++i) {
    const double t = 0.1 * i;
    const auto row = prediction.derivatives(0).row(i);
    worst = std::max({worst, std::abs(row[0] - std::exp(p[1] * t)),
                      std::abs(row[1] - p[0] * t * std::exp(p[1] * t)), std::abs(row[4] - 1)});
  }
  return worst;
}

TEST(DifferencedProblem, DerivativesAreAsAccurateAsStated) {
  const Simulator exact;
  // 4e-11 of derivatives of about 1; the smallest step is a thousandth of 6e-6, of rounding 2e-16.
  constexpr double kOfRounding = 1e-6;
  EXPECT_LT(WorstError(exact, RestPoint(exact)), kOfRounding);
  const Simulator rounded(1e-8);
  Vector p = RestPoint(rounded);
  p[4] = 5e-3;
  // (1e-8)^(2/3) = 5e-6 times a factor for the small step of a logarithmic parameter: 1e-8 / (2e-3 * 5e-3).
  EXPECT_LT(WorstError(rounded, p), 2e-3);
}

TEST(DifferencedProblem, StepsStayInsideOfTheBounds) {
  const Simulator simulator;  // it throws outside
  for (const double b : {-2.0, 0.0}) {
    Vector p = RestPoint(simulator);
    p[0] = b < -1 ? -3 : 3;
    p[1] = b;
    EXPECT_LT(WorstError(simulator, p), 1e-6) << b;
  }
}

TEST(DifferencedProblem, TheSlopeAtTheNullOfAKinkIsASecant) {
  const Simulator simulator;
  const Prediction prediction = Predict(simulator, RestPoint(simulator));
  for (int i = 0; i < 20; ++i) EXPECT_DOUBLE_EQ(prediction.derivatives(0)(i, 3), 1 / 0.25);
}

TEST(DifferencedProblem, WhatIsNotWantedIsLeftAsItIs) {
  const Simulator simulator;
  Prediction prediction(simulator.layout());
  prediction.derivatives(0).setConstant(7);
  const auto workspace = simulator.NewWorkspace();
  const std::vector<bool> all(1, true);
  const std::vector<bool> some{true, false, false, false, false};
  const Vector rest = RestPoint(simulator);
  ASSERT_TRUE(simulator.Predict({rest, all, true, &some}, *workspace, prediction));
  EXPECT_TRUE((prediction.derivatives(0).rightCols(4).array() == 7).all());
  EXPECT_DOUBLE_EQ(prediction.derivatives(0)(0, 0), 1);
  EXPECT_EQ(Vector(prediction.values(0)), Vector(Predict(simulator, rest).values(0)));
}

TEST(DifferencedProblem, AFailureBesideThePointIsNamedWithItsParameter) {
  Simulator simulator;
  simulator.fails_below = -1;
  Prediction prediction(simulator.layout());
  const auto workspace = simulator.NewWorkspace();
  const std::vector<bool> all(1, true);
  EXPECT_EQ(ErrorOf(simulator.Predict({RestPoint(simulator), all, true, nullptr}, *workspace, prediction)),
            "beside 'b' for its derivative: it did not settle");
}

TEST(DifferencedProblem, IsIdentifiedLikeAnyOther) {
  const Simulator simulator;
  EXPECT_EQ(ErrorOf(CheckProblem(simulator)), "");
  FitRequest request;
  request.fix = {{"tiny", 1e-6}, {"large", 1.5e5}};
  const auto found = Identify(simulator, MakeFitSetup(simulator, request).value(), {});
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_TRUE(found->result.stop.converged());
  EXPECT_NEAR(found->parameters[0], 2, 1e-5);
  EXPECT_NEAR(found->parameters[1], -0.5, 1e-5);
}

}  // namespace
}  // namespace sinew
