#include "identify/check_problem.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <stdexcept>

#include "base/constants.h"
#include "identify/diagnosis/diagnosis.h"
#include "identify/identification/identification.h"
#include "identify/observation/sensor_effects.h"
#include "tests/identify/support/error_of.h"

namespace sinew {
namespace {

using testing::HasSubstr;

/// y = scale exp(-rate t) + offset t on a training and a validation trial; `offset` is an effect. Everything
/// can be spoilt.
class Decay final : public Problem {
 public:
  enum { kRate, kScale, kOffset };

  Decay() {
    parameters_ = {BaseParameter("rate", "1/s", "of the decay", 0.1, 5, 1),
                   BaseParameter("scale", "m", "at the begin", 0.1, 5, 2),
                   EffectParameter("offset", "m/s", "of the reading", -1, 1, 0, "drifts")};
    effects_ = {{"drifts", Level::kSensor, "the reading drifts", "a longer trial", {kOffset}}};
    for (const char* trial : {"first", "second"}) {
      Block block;
      block.trial = trial;
      block.channel = "y";
      block.unit = "m";
      block.role = layout_.empty() ? BlockRole::kTrain : BlockRole::kValidate;
      for (int i = 0; i < 30; ++i) {
        block.prediction_time.push_back(0.1 * i);
        block.sample.push_back(i);
        block.measured.push_back(2.2 * std::exp(-0.12 * i) + 0.01 * std::cos(7 * i));
      }
      block.columns = {0, 1, 2};
      layout_.push_back(std::move(block));
    }
  }

  [[nodiscard]] const std::vector<Parameter>& parameters() const override { return parameters_; }
  [[nodiscard]] const Layout& layout() const override { return layout_; }
  [[nodiscard]] const std::vector<Effect>& effects() const override { return effects_; }
  [[nodiscard]] const std::vector<Constraint>& constraints() const override { return constraints_; }

  Status Predict(const Query& query, Workspace& /*workspace*/, Prediction& prediction) const override {
    for (int b = 0; b < 2; ++b) {
      if (!query.blocks[static_cast<std::size_t>(b)]) continue;
      const auto& time = layout_[static_cast<std::size_t>(b)].prediction_time;
      for (std::size_t i = 0; i < time.size(); ++i) {
        const double decay = std::exp(-query.parameters[kRate] * time[i]);
        const auto row = static_cast<Eigen::Index>(i);
        prediction.values(b)[row] = query.parameters[kScale] * decay + query.parameters[kOffset] * time[i];
        if (!query.derivatives) continue;
        prediction.derivatives(b)(row, kRate) = -query.parameters[kScale] * time[i] * decay;
        prediction.derivatives(b)(row, kScale) = decay;
        prediction.derivatives(b)(row, kOffset) = time[i];
      }
    }
    return spoil ? spoil(query, prediction) : Status();
  }

  std::vector<Parameter> parameters_;
  Layout layout_;
  std::vector<Effect> effects_;
  std::vector<Constraint> constraints_;
  std::function<Status(const Query&, Prediction&)> spoil;
};

// The error that a user gets who goes straight to a fit.
std::string ErrorOfIdentify(const Decay& problem) {
  const auto setup = MakeFitSetup(problem, {});
  if (!setup) return setup.error().message;
  return ErrorOf(Identify(problem, *setup, {}));
}

std::string ErrorOfDiagnose(const Decay& problem) {
  const auto setup = MakeFitSetup(problem, {});
  if (!setup) return setup.error().message;
  return ErrorOf(Diagnose(problem, *setup, {}));
}

// All three entries find it, with the same words in it.
void ExpectFoundEverywhere(const Decay& problem, const std::string& words) {
  EXPECT_THAT(ErrorOf(CheckProblem(problem)), HasSubstr(words));
  EXPECT_THAT(ErrorOfIdentify(problem), HasSubstr(words));
  EXPECT_THAT(ErrorOfDiagnose(problem), HasSubstr(words));
}

// A joint that sticks leaves its rest a little to both sides of the start: differences over that distance
// agree with each other, not with the derivative.
TEST(CheckProblem, AModelThatSwitchesNearTheStartPasses) {
  Decay sticks;
  sticks.spoil = [](const Query& query, Prediction& prediction) {
    const double off = query.parameters[Decay::kOffset];
    const double rest = 1e-5;  // of a range of 2
    if (std::abs(off) < rest) return Status();
    for (int b = 0; b < 2; ++b) {
      if (query.blocks[static_cast<std::size_t>(b)]) prediction.values(b).array() -= 0.5 * off;
    }
    return Status();
  };
  EXPECT_EQ(ErrorOf(CheckProblem(sticks)), "");
}

TEST(CheckProblem, AGoodProblemPasses) {
  const Decay good;
  EXPECT_EQ(ErrorOf(CheckProblem(good)), "");
  EXPECT_EQ(ErrorOfIdentify(good), "");
  EXPECT_EQ(ErrorOfDiagnose(good), "");
}

TEST(CheckProblem, FewerSamplesThanMeasuredValuesAreNamedWithTheBlock) {
  Decay bad;
  bad.layout_[1].sample.resize(10);
  ExpectFoundEverywhere(bad, "block second/y: 10 sample indices but 30 measured values");
}

TEST(CheckProblem, ASampleBeyondThePredictionIsNamed) {
  Decay bad;
  bad.layout_[0].sample.back() = 30;
  ExpectFoundEverywhere(bad, "block first/y: sample[29] = 30");
}

TEST(CheckProblem, UnsortedColumnsAreNamed) {
  Decay bad;
  bad.layout_[0].columns = {1, 0, 2};
  ExpectFoundEverywhere(bad, "block first/y: columns[1] = 0");
}

TEST(CheckProblem, AGapInMeasuredValuesIsNamed) {
  Decay bad;
  bad.layout_[0].measured[7] = kNaN;
  ExpectFoundEverywhere(bad, "block first/y: measured[7] = nan");
}

TEST(CheckProblem, AnEffectIndexOutOfRangeIsNamed) {
  Decay bad;
  bad.effects_[0].parameters = {3};
  ExpectFoundEverywhere(bad, "effect 'drifts': parameter index 3 is out of range, expected 0 .. 2");
}

TEST(CheckProblem, AParameterOfAnotherEffectIsNamed) {
  Decay bad;
  bad.effects_[0].parameters = {Decay::kRate};
  ExpectFoundEverywhere(bad, "effect 'drifts': its parameter 'rate' (index 0) belongs to no effect");
}

TEST(CheckProblem, ConstraintsNeedACoefficientPerParameter) {
  Decay bad;
  bad.constraints_ = {{"sum", Vector::Ones(2), 0}};
  EXPECT_THAT(ErrorOf(CheckProblem(bad)), HasSubstr("constraint 'sum': 2 coefficients"));
}

TEST(CheckProblem, AValueThatIsNotSetIsNamedWithItsTime) {
  Decay bad;
  bad.spoil = [](const Query&, Prediction& prediction) {
    prediction.values(0)[4] = kNaN;
    return Status();
  };
  ExpectFoundEverywhere(bad, "block first/y, prediction 4 (t = 0.4 s): the predicted value is nan");
}

TEST(CheckProblem, AForgottenDerivativeIsNamedWithItsParameter) {
  // A class without any code for derivatives leaves what was there.
  class Forgetful final : public Problem {
   public:
    [[nodiscard]] const std::vector<Parameter>& parameters() const override { return inner.parameters(); }
    [[nodiscard]] const Layout& layout() const override { return inner.layout(); }
    Status Predict(const Query& query, Workspace& workspace, Prediction& prediction) const override {
      return inner.Predict({query.parameters, query.blocks}, workspace, prediction);
    }
    Decay inner;
  };
  const Forgetful bad;
  EXPECT_THAT(ErrorOf(CheckProblem(bad)), HasSubstr("the derivative by 'rate' is nan: not set"));
  const auto setup = MakeFitSetup(bad, {});
  EXPECT_THAT(ErrorOf(Identify(bad, *setup, {})), HasSubstr("the derivative by 'rate' is nan: not set"));
}

TEST(CheckProblem, ADerivativeLeftAtZeroIsComparedWithDifferences) {
  Decay bad;
  bad.spoil = [](const Query& query, Prediction& prediction) {
    if (query.derivatives) prediction.derivatives(0).col(Decay::kRate).setZero();
    return Status();
  };
  ExpectFoundEverywhere(bad, "the derivative by 'rate' is 0, but differences of the predictions give -");
}

TEST(CheckProblem, ADerivativeOfTheWrongSignIsNamed) {
  Decay bad;
  bad.spoil = [](const Query& query, Prediction& prediction) {
    if (query.derivatives) prediction.derivatives(0).col(Decay::kScale) *= -1;
    return Status();
  };
  ExpectFoundEverywhere(bad, "the derivative by 'scale' is -");
}

TEST(CheckProblem, AnEffectsDerivativeIsCheckedToo) {
  Decay bad;
  bad.spoil = [](const Query& query, Prediction& prediction) {
    if (query.derivatives) prediction.derivatives(0).col(Decay::kOffset).setZero();
    return Status();
  };
  EXPECT_THAT(ErrorOf(CheckProblem(bad)), HasSubstr("the derivative by 'offset' is 0"));
}

/// Two effects add to y: `first` sin(t), and `second` twice that, or sin(t) and a little of cos(t), or only
/// where the rate is 1.
class TwoEffects final : public Problem {
 public:
  enum class Second { kSame, kOther, kSameAtTheStart };

  explicit TwoEffects(Second second) : second_(second) {
    parameters_ = {BaseParameter("rate", "1/s", "of y", 0.1, 5, 1),
                   EffectParameter("first_size", "m", "of the first", -1, 1, 0, "first"),
                   EffectParameter("second_size", "m", "of the second", -1, 1, 0, "second")};
    effects_ = {{"first", Level::kSensor, "the first", "", {1}},
                {"second", Level::kSensor, "the second", "", {2}}};
    Block block;
    block.trial = "one";
    block.channel = "y";
    block.unit = "m";
    for (int i = 0; i < 30; ++i) {
      block.prediction_time.push_back(0.1 * i);
      block.sample.push_back(i);
      block.measured.push_back(std::sin(i));
    }
    block.columns = {0, 1, 2};
    layout_.push_back(std::move(block));
  }
  [[nodiscard]] const std::vector<Parameter>& parameters() const override { return parameters_; }
  [[nodiscard]] const Layout& layout() const override { return layout_; }
  [[nodiscard]] const std::vector<Effect>& effects() const override { return effects_; }
  Status Predict(const Query& query, Workspace& /*workspace*/, Prediction& prediction) const override {
    const Vector& p = query.parameters;
    for (int i = 0; i < 30; ++i) {
      const double t = 0.1 * i;
      const double rate = second_ == Second::kSameAtTheStart ? p[0] : 1;
      const double other = second_ == Second::kOther ? 0.01 * std::cos(t) : 0;
      const double slope = 2 * std::sin(rate * t) + other;
      prediction.values(0)[i] = p[0] * t + p[1] * std::sin(t) + p[2] * slope;
      if (!query.derivatives) continue;
      const double by_rate = second_ == Second::kSameAtTheStart ? 2 * t * std::cos(rate * t) : 0;
      prediction.derivatives(0).row(i) << t + p[2] * by_rate, std::sin(t), slope;
    }
    return {};
  }

 private:
  Second second_;
  std::vector<Parameter> parameters_;
  std::vector<Effect> effects_;
  Layout layout_;
};

TEST(CheckProblem, TwoEffectsThatAreOneAreNamed) {
  EXPECT_EQ(
      ErrorOf(CheckProblem(TwoEffects(TwoEffects::Second::kSame))),
      "effects 'first' and 'second' are one: both change every prediction in the same way, whatever the "
      "parameters; declare one of them, or bring data that tell them apart");
  EXPECT_EQ(ErrorOf(CheckProblem(TwoEffects(TwoEffects::Second::kOther))), "");
  EXPECT_EQ(ErrorOf(CheckProblem(TwoEffects(TwoEffects::Second::kSameAtTheStart))), "");
}

TEST(CheckProblem, WhatAModelThrowsIsAnError) {
  Decay bad;
  bad.spoil = [](const Query&, Prediction&) -> Status { throw std::runtime_error("no table loaded"); };
  ExpectFoundEverywhere(bad, "the model threw at the start values: no table loaded");
}

TEST(CheckProblem, DataWithoutATrainingTrialArePredictedButNotFitted) {
  Decay held_out;
  for (Block& block : held_out.layout_) block.role = BlockRole::kValidate;
  EXPECT_EQ(ErrorOf(CheckProblem(held_out)), "");
  const std::string words = "no trial with the role train has a channel that is compared: nothing to fit";
  EXPECT_EQ(ErrorOf(CheckSomethingToFit(held_out)), words);
  EXPECT_EQ(ErrorOfIdentify(held_out), words);
  EXPECT_EQ(ErrorOfDiagnose(held_out), words);
}

TEST(CheckProblem, AStartThatTheProblemRefusesIsNoFaultOfAFit) {
  Decay refused;
  refused.spoil = [](const Query&, Prediction&) -> Status { return Fail("the step is too long"); };
  EXPECT_EQ(ErrorOf(CheckProblem(refused)), "no prediction at the start values: the step is too long");
  EXPECT_EQ(ErrorOf(CheckProblem(refused, *MakeFitSetup(refused, {}))), "");
}

TEST(CheckProblem, AKinkIsNoWrongDerivative) {
  // |rate - start|: the slope to the right is returned, differences say 0.
  Decay kinked;
  kinked.spoil = [](const Query& query, Prediction& prediction) {
    const double off = query.parameters[Decay::kRate] - 1;
    for (int b = 0; b < 2; ++b) {
      prediction.values(b).array() += 5 * std::abs(off);
      if (query.derivatives) prediction.derivatives(b).col(Decay::kRate).array() += off < 0 ? -5 : 5;
    }
    return Status();
  };
  EXPECT_EQ(ErrorOf(CheckProblem(kinked)), "");
}

TEST(CheckProblem, AStartOnAKinkIsNoWrongDerivative) {
  // Held by friction at the very start values, and nowhere beside them.
  Decay held;
  held.spoil = [](const Query& query, Prediction& prediction) {
    const double off = query.parameters[Decay::kRate] - 1;
    for (int b = 0; b < 2; ++b) {
      prediction.values(b).array() += 5 * off;
      if (query.derivatives && off != 0) prediction.derivatives(b).col(Decay::kRate).array() += 5;
    }
    return Status();
  };
  EXPECT_EQ(ErrorOf(CheckProblem(held)), "");
}

// Decay with its readings rounded to multiples of `step`, behind sensor effects.
SensorEffects Quantised(double step, std::function<Status(const Query&, Prediction&)> spoil = nullptr) {
  auto inner = std::make_unique<Decay>();
  for (Block& block : inner->layout_) {
    for (double& value : block.measured) value = step * std::round(value / step);
  }
  inner->spoil = std::move(spoil);
  return SensorEffects(std::move(inner));
}

FitRequest Releasing(const std::string& effect) {
  FitRequest request;
  request.release = {effect};
  return request;
}

TEST(CheckProblem, AReleasedQuantisationIsNoWrongDerivative) {
  // Derivatives are those before rounding, of which differences show nothing.
  const double step = 0.05;
  const SensorEffects problem = Quantised(step);
  const auto at_the_step = MakeFitSetup(problem, Releasing("y.quantisation"));
  ASSERT_TRUE(at_the_step) << at_the_step.error().message;
  ASSERT_NEAR(at_the_step->rest[*FindParameter(problem.parameters(), "y.quantisation")], step, 1e-3);
  EXPECT_EQ(ErrorOf(CheckProblem(problem, *at_the_step)), "");
  EXPECT_EQ(ErrorOf(CheckProblem(problem)), "");
  const auto fit = Identify(problem, *at_the_step, {});
  EXPECT_TRUE(fit) << fit.error().message;

  FitRequest coarse = Releasing("y.quantisation");
  coarse.start = {{"y.quantisation", 0.08}};
  EXPECT_EQ(ErrorOf(CheckProblem(problem, *MakeFitSetup(problem, coarse))), "");
  FitRequest fixed;
  fixed.fix = {{"y.quantisation", 0.08}};
  EXPECT_EQ(ErrorOf(CheckProblem(problem, *MakeFitSetup(problem, fixed))), "");

  const auto report = CheckJacobian(problem);
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_TRUE(report->wrong.empty());
}

TEST(CheckProblem, AWrongDerivativeIsNamedBehindAQuantisation) {
  const SensorEffects problem = Quantised(0.05, [](const Query& query, Prediction& prediction) {
    if (query.derivatives) prediction.derivatives(0).col(Decay::kRate) *= -1;
    return Status();
  });
  EXPECT_THAT(ErrorOf(CheckProblem(problem, *MakeFitSetup(problem, Releasing("y.quantisation")))),
              HasSubstr("the derivative by 'rate' is "));
}

TEST(CheckJacobian, RightDerivativesAgreeEverywhere) {
  const Decay good;
  const auto report = CheckJacobian(good);
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_TRUE(report->wrong.empty());
  EXPECT_TRUE(report->never.empty());
  EXPECT_EQ(report->columns, 3 * 2 * 3);  // points, blocks, parameters
  EXPECT_EQ(report->compared, report->columns);
  EXPECT_LT(report->worst, 1e-6);
}

TEST(CheckJacobian, SaysWhichDerivativeWhereAndWhatWasExpected) {
  Decay bad;
  bad.spoil = [](const Query& query, Prediction& prediction) {
    if (query.derivatives) prediction.derivatives(1).col(Decay::kRate) *= 1.01;
    return Status();
  };
  const auto report = CheckJacobian(bad);
  ASSERT_TRUE(report) << report.error().message;
  ASSERT_EQ(report->wrong.size(), 1U);
  const WrongDerivative& wrong = report->wrong[0];
  EXPECT_EQ(wrong.trial, "second");
  EXPECT_EQ(wrong.channel, "y");
  EXPECT_EQ(wrong.name, "rate");
  EXPECT_EQ(wrong.parameter, Decay::kRate);
  EXPECT_NEAR(wrong.got / wrong.expected, 1.01, 1e-6);
  EXPECT_NEAR(wrong.deviation, 0.01 / 1.01, 1e-6);
  EXPECT_NEAR(wrong.expected,
              -wrong.point[Decay::kScale] * wrong.time * std::exp(-wrong.point[Decay::kRate] * wrong.time),
              1e-5 * std::abs(wrong.expected));
}

}  // namespace
}  // namespace sinew
