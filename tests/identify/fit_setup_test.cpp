#include "identify/fit_setup.h"

#include <gtest/gtest.h>

#include <utility>

#include "tests/identify/support/error_of.h"
#include "tests/identify/support/function_problem.h"
#include "tests/identify/support/toy_problem.h"

namespace sinew {
namespace {

using toy::MakeParameter;
using toy::Values;

enum Index { kMass, kDamping, kInitial, kDragLinear, kDragSquare, kOffset };

// Two base parameters, a nuisance value, and the effects drag (two parameters) and offset.
class Cart final : public FunctionProblem {
 public:
  Cart() {
    Add(MakeParameter("mass", 1, 10, 2));
    Add(MakeParameter("damping", 0, 5, 1));
    Add(MakeParameter("initial", -1, 1, 0.25, ParameterKind::kNuisance));
    AddOfEffect("drag.linear", "drag", 0.5);
    AddOfEffect("drag.square", "drag", 0.75);
    AddOfEffect("offset", "offset", 0.125);
  }
  [[nodiscard]] const std::vector<Effect>& effects() const override { return effects_; }

 private:
  void AddOfEffect(const std::string& name, const std::string& effect, double start) {
    Parameter p = MakeParameter(name, -1, 1, start, ParameterKind::kEffect);
    p.effect = effect;
    Add(p);
  }
  std::vector<Effect> effects_{
      {"drag", Level::kRobot, "air resists", "fast motion", {kDragLinear, kDragSquare}},
      {"offset", Level::kSensor, "the sensor reads too much", "rest", {kOffset}}};
};

class FitSetupTest : public testing::Test {
 protected:
  [[nodiscard]] FitSetup Make(const FitRequest& request) const {
    auto setup = MakeFitSetup(cart_, request);
    EXPECT_EQ(ErrorOf(setup), "");
    return setup ? *setup : FitSetup{};
  }
  [[nodiscard]] std::string ErrorFor(const FitRequest& request) const {
    return ErrorOf(MakeFitSetup(cart_, request));
  }
  const Cart cart_;
};

TEST_F(FitSetupTest, FreesBaseAndNuisanceParametersAndRestsEffectsAtTheirNull) {
  const FitSetup setup = Make({});
  EXPECT_EQ(setup.free, (std::vector<int>{kMass, kDamping, kInitial}));
  EXPECT_EQ(setup.rest, Values({2, 1, 0.25, 0, 0, 0}));
  EXPECT_TRUE(setup.IsFree(kInitial));
  EXPECT_FALSE(setup.IsFree(kOffset));
}

TEST_F(FitSetupTest, FreeChoosesAmongBaseParametersAndKeepsNuisances) {
  FitRequest request;
  request.free = {"damping"};
  EXPECT_EQ(Make(request).free, (std::vector<int>{kDamping, kInitial}));
}

TEST_F(FitSetupTest, AnEffectParameterCanBeFreedByItself) {
  FitRequest request;
  request.free = {"damping", "drag.square"};
  const FitSetup setup = Make(request);
  EXPECT_EQ(setup.free, (std::vector<int>{kDamping, kInitial, kDragSquare}));
  EXPECT_EQ(setup.rest, Values({2, 1, 0.25, 0, 0.75, 0}));
}

TEST_F(FitSetupTest, ReleaseFreesAllParametersOfAnEffectFromTheirStarts) {
  FitRequest request;
  request.release = {"drag"};
  const FitSetup setup = Make(request);
  EXPECT_EQ(setup.free, (std::vector<int>{kMass, kDamping, kInitial, kDragLinear, kDragSquare}));
  EXPECT_EQ(setup.rest, Values({2, 1, 0.25, 0.5, 0.75, 0}));
}

// A saturation: at its null no prediction depends on it, so that a local search would not change it.
class Saturated final : public FunctionProblem {
 public:
  Saturated() {
    Add(MakeParameter("mass", 1, 10, 2));
    AddOfEffect("limit", "saturation", {0.1, 0.2, 0.4});
    AddOfEffect("break", "friction", {});
    AddOfEffect("width", "friction", {0.3});
  }
  [[nodiscard]] const std::vector<Effect>& effects() const override { return effects_; }

 private:
  void AddOfEffect(const std::string& name, const std::string& effect, std::vector<double> probes) {
    Parameter p = MakeParameter(name, -1, 1, 0, ParameterKind::kEffect);
    p.effect = effect;
    p.probes = std::move(probes);
    Add(p);
  }
  std::vector<Effect> effects_{{"saturation", Level::kRobot, "it clips", "large motion", {1}},
                               {"friction", Level::kRobot, "it sticks", "slow motion", {2, 3}}};
};

TEST(FitSetup, AReleasedEffectWithoutSlopeStartsAtAProbe) {
  const Saturated problem;
  const auto rest = [&](const FitRequest& request) {
    auto setup = MakeFitSetup(problem, request);
    EXPECT_EQ(ErrorOf(setup), "");
    return setup ? setup->rest : Vector();
  };
  FitRequest request;
  request.release = {"friction"};  // "break" has a slope at the null
  EXPECT_EQ(rest(request), Values({2, 0, 0, 0}));
  request.release = {"saturation"};
  EXPECT_EQ(rest(request), Values({2, 0.2, 0, 0}));
  request.bounds = {{"limit", {-0.1, 0.1}}};  // the probe lies outside
  EXPECT_EQ(rest(request), Values({2, 0, 0, 0}));
  request.bounds.clear();
  request.start = {{"limit", 0}};
  EXPECT_EQ(rest(request), Values({2, 0, 0, 0}));
}

TEST_F(FitSetupTest, FixHoldsAnyParameterAtAValue) {
  FitRequest request;
  request.fix = {{"mass", 3}, {"initial", 0}, {"offset", 0.5}};
  const FitSetup setup = Make(request);
  EXPECT_EQ(setup.free, (std::vector<int>{kDamping}));
  EXPECT_EQ(setup.rest, Values({3, 1, 0, 0, 0, 0.5}));
}

TEST_F(FitSetupTest, FixHoldsOneParameterOfAReleasedEffect) {
  FitRequest request;
  request.release = {"drag"};
  request.fix = {{"drag.linear", 0.25}};
  const FitSetup setup = Make(request);
  EXPECT_EQ(setup.free, (std::vector<int>{kMass, kDamping, kInitial, kDragSquare}));
  EXPECT_EQ(setup.rest[kDragLinear], 0.25);
}

TEST_F(FitSetupTest, BoundsAndStartsReplaceThoseOfTheProblem) {
  FitRequest request;
  request.bounds = {{"mass", {4, 20}}};
  request.start = {{"mass", 15}};
  request.fix = {{"damping", 2}};
  const FitSetup setup = Make(request);
  EXPECT_EQ(setup.parameters[kMass].lower, 4);
  EXPECT_EQ(setup.parameters[kMass].upper, 20);
  EXPECT_EQ(setup.rest[kMass], 15);
  EXPECT_EQ(cart_.parameters()[kMass].upper, 10) << "the problem itself must stay as it is";
}

TEST_F(FitSetupTest, AFixedValueIsJudgedByTheRequestedBounds) {
  FitRequest request;
  request.bounds = {{"mass", {4, 20}}};
  request.fix = {{"mass", 15}};
  EXPECT_EQ(Make(request).rest[kMass], 15);
  request.fix = {{"mass", 3}};
  EXPECT_EQ(ErrorFor(request), "parameter 'mass': fixed at 3, outside its bounds 4 .. 20 [1]");
}

TEST_F(FitSetupTest, UnknownNamesAreErrorsWithASuggestion) {
  const std::string message = "parameter 'dampin' does not exist; did you mean 'damping'?";
  FitRequest request;
  request.free = {"dampin"};
  EXPECT_EQ(ErrorFor(request), message);
  request = {};
  request.fix = {{"dampin", 1}};
  EXPECT_EQ(ErrorFor(request), message);
  request = {};
  request.bounds = {{"dampin", {0, 1}}};
  EXPECT_EQ(ErrorFor(request), message);
  request = {};
  request.start = {{"dampin", 1}};
  EXPECT_EQ(ErrorFor(request), message);
  request = {};
  request.release = {"ofset"};
  EXPECT_EQ(ErrorFor(request), "effect 'ofset' does not exist; did you mean 'offset'?");
}

TEST_F(FitSetupTest, ReleasingFromAProblemWithoutEffectsIsAnError) {
  FunctionProblem problem;
  problem.Add("a", 0, 1, 0.5);
  FitRequest request;
  request.release = {"drag"};
  EXPECT_EQ(ErrorOf(MakeFitSetup(problem, request)),
            "effect 'drag' does not exist: this problem declares none");
}

TEST_F(FitSetupTest, BoundsThatExcludeTheStartAreAnError) {
  FitRequest request;
  request.bounds = {{"mass", {4, 20}}};
  EXPECT_EQ(ErrorFor(request), "parameter 'mass': start 2 lies outside its bounds 4 .. 20 [1]");
  request.bounds = {{"mass", {20, 4}}};
  EXPECT_EQ(ErrorFor(request), "parameter 'mass': bounds 20 .. 4 are not a finite interval [1]");
  request = {};
  request.start = {{"mass", 0.5}};
  EXPECT_EQ(ErrorFor(request), "parameter 'mass': start 0.5 lies outside its bounds 1 .. 10 [1]");
}

TEST_F(FitSetupTest, FreeAndFixedIsAnError) {
  FitRequest request;
  request.free = {"mass", "damping"};
  request.fix = {{"mass", 2}};
  EXPECT_EQ(ErrorFor(request), "parameter 'mass' is asked to be both free and fixed");
}

TEST_F(FitSetupTest, AValueThatIsNoNumberIsAnError) {
  FitRequest request;
  request.fix = {{"mass", std::nan("")}};
  EXPECT_EQ(ErrorFor(request), "parameter 'mass': fixed at nan, outside its bounds 1 .. 10 [1]");
}

}  // namespace
}  // namespace sinew
