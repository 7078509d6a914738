#include "identify/parameter.h"

#include <gtest/gtest.h>

#include <limits>

#include "base/constants.h"
#include "tests/identify/support/error_of.h"

namespace sinew {
namespace {

Parameter Stiffness() {
  Parameter p;
  p.name = "stiffness";
  p.unit = "N/m";
  p.lower = 10;
  p.upper = 1000;
  p.start = 100;
  p.scale = Scale::kLog;
  return p;
}

Parameter Offset() {
  Parameter p;
  p.name = "force.offset";
  p.unit = "N";
  p.lower = -5;
  p.upper = 5;
  p.start = 1;
  p.kind = ParameterKind::kEffect;
  p.effect = "force.offset";
  return p;
}

template <class Change>
std::string ErrorAfter(Parameter parameter, Change change) {
  change(parameter);
  return ErrorOf(CheckParameters({parameter}));
}

TEST(Parameter, GoodOnesPass) {
  EXPECT_EQ(ErrorOf(CheckParameters({Stiffness(), Offset()})), "");
  EXPECT_EQ(ErrorOf(CheckParameters({})), "");
  // On its bounds is within its bounds.
  EXPECT_EQ(ErrorAfter(Stiffness(), [](Parameter& p) { p.start = p.lower; }), "");
  EXPECT_EQ(ErrorAfter(Offset(), [](Parameter& p) { p.null_value = p.upper; }), "");
}

TEST(Parameter, NamesMustBeThereAndUnique) {
  EXPECT_EQ(ErrorAfter(Stiffness(), [](Parameter& p) { p.name = ""; }), "a parameter has no name");
  EXPECT_EQ(ErrorOf(CheckParameters({Stiffness(), Offset(), Stiffness()})),
            "parameter 'stiffness' stands there twice");
}

TEST(Parameter, BoundsMustBeAFiniteInterval) {
  EXPECT_EQ(ErrorAfter(Stiffness(), [](Parameter& p) { p.upper = 5; }),
            "parameter 'stiffness': bounds 10 .. 5 are not a finite interval [N/m]");
  EXPECT_EQ(ErrorAfter(Stiffness(), [](Parameter& p) { p.upper = p.lower; }),
            "parameter 'stiffness': bounds 10 .. 10 are not a finite interval [N/m]");
  EXPECT_EQ(ErrorAfter(Stiffness(), [](Parameter& p) { p.lower = kNaN; }),
            "parameter 'stiffness': bounds nan .. 1000 are not a finite interval [N/m]");
  EXPECT_EQ(ErrorAfter(Stiffness(), [](Parameter& p) { p.upper = kInfinity; }),
            "parameter 'stiffness': bounds 10 .. inf are not a finite interval [N/m]");
}

TEST(Parameter, ALogarithmicScaleNeedsValuesAboveZero) {
  EXPECT_EQ(ErrorAfter(Stiffness(), [](Parameter& p) { p.lower = 0; }),
            "parameter 'stiffness': lower bound 0 must be above 0 on a logarithmic scale");
}

TEST(Parameter, StartMustLieWithinTheBounds) {
  EXPECT_EQ(ErrorAfter(Stiffness(), [](Parameter& p) { p.start = 9; }),
            "parameter 'stiffness': start 9 lies outside its bounds 10 .. 1000 [N/m]");
  EXPECT_EQ(ErrorAfter(Stiffness(), [](Parameter& p) { p.start = kNaN; }),
            "parameter 'stiffness': start nan lies outside its bounds 10 .. 1000 [N/m]");
}

TEST(Parameter, OfAnEffectNeedsTheEffectAndItsNull) {
  EXPECT_EQ(ErrorAfter(Offset(), [](Parameter& p) { p.effect = ""; }),
            "parameter 'force.offset' belongs to no effect");
  EXPECT_EQ(ErrorAfter(Offset(), [](Parameter& p) { p.null_value = 6; }),
            "parameter 'force.offset': null value 6 lies outside its bounds -5 .. 5");
}

TEST(Parameter, PriorMustBeADensity) {
  const auto with_prior = [](double mean, double deviation) {
    return ErrorAfter(Stiffness(), [&](Parameter& p) { p.prior = GaussianPrior{mean, deviation}; });
  };
  EXPECT_EQ(with_prior(4, 0.5), "");
  EXPECT_EQ(with_prior(4, 0),
            "parameter 'stiffness': its prior has standard deviation 0, expected a number above 0");
  EXPECT_EQ(with_prior(4, kInfinity),
            "parameter 'stiffness': its prior has standard deviation inf, expected a number above 0");
  EXPECT_EQ(with_prior(kNaN, 1), "parameter 'stiffness': its prior has mean nan, expected a number");
}

TEST(Parameter, RestsAtItsStartAndAnEffectAtItsNull) {
  EXPECT_EQ(Stiffness().rest_value(), 100);
  EXPECT_EQ(Offset().rest_value(), 0);
}

TEST(Parameter, IsFoundByName) {
  const std::vector<Parameter> parameters{Stiffness(), Offset()};
  EXPECT_EQ(FindParameter(parameters, "force.offset").value(), 1);
  EXPECT_EQ(ErrorOf(FindParameter(parameters, "stifness")),
            "parameter 'stifness' does not exist; did you mean 'stiffness'?");
  EXPECT_EQ(ErrorOf(FindParameter(parameters, "mass")),
            "parameter 'mass' does not exist; expected one of stiffness, force.offset");
}

}  // namespace
}  // namespace sinew
