// Sets of effects that do to the data what a set of causes does.
#include "identify/diagnosis/select/imitating_sets.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "identify/diagnosis/select/linearised_model.h"
#include "tests/identify/diagnosis/linear_laws.h"
#include "tests/identify/support/error_of.h"

namespace sinew::diagnosis {
namespace {

using testing::Contains;
using testing::Each;
using testing::IsEmpty;
using testing::Not;
using EffectNames = std::vector<std::string>;

LinearLaws::Truth Hidden(const std::vector<std::pair<std::string, double>>& effects, double noise) {
  LinearLaws::Truth truth;
  truth.effects = effects;
  truth.noise = noise;
  truth.lopsided = true;
  return truth;
}

/// A model with these causes, fitted to data with that truth.
class Modelled {
 public:
  Modelled(const LinearLaws::Truth& truth, const EffectNames& causes, const FitRequest& request = {})
      : problem(truth, 5) {
    const FitSetup setup = MakeFitSetup(problem, request).value();
    nulls = setup.rest;
    candidates = ListCandidates(problem, setup);
    std::vector<int> released;
    for (const std::string& name : causes) released.push_back(Of(name));
    std::sort(released.begin(), released.end());
    model = Refitter(problem, setup, candidates).Fit(released, {setup.rest});
    EXPECT_TRUE(model.usable()) << model.failure;
  }

  [[nodiscard]] int Of(const std::string& effect) const {
    for (std::size_t c = 0; c < candidates.size(); ++c) {
      if (candidates[c].effect == effect) return static_cast<int>(c);
    }
    ADD_FAILURE() << effect;
    return 0;
  }
  [[nodiscard]] std::map<EffectNames, std::vector<Vector>> Sets() const {
    std::map<EffectNames, std::vector<Vector>> named;
    const auto found = FindImitatingSets(problem, candidates, model, nulls);
    EXPECT_TRUE(found) << found.error().message;
    for (const auto& [set, starts] : *found) {
      EffectNames names;
      for (const int c : set) names.push_back(candidates[static_cast<std::size_t>(c)].effect);
      std::sort(names.begin(), names.end());
      named[names] = starts;
    }
    return named;
  }
  [[nodiscard]] EffectNames Keys() const {
    EffectNames keys;
    for (const auto& [names, starts] : Sets()) {
      std::string key;
      for (const std::string& name : names) key += (key.empty() ? "" : "+") + name;
      keys.push_back(key);
    }
    return keys;
  }

  LinearLaws problem;
  Vector nulls;
  std::vector<Candidate> candidates;
  Refit model;
};

TEST(ImitatingSets, TheTrueCausesAreAmongThemWithTheirValues) {
  // The twin is nearly the step, and the lopsided law contains the quadratic one.
  const Modelled wrong(Hidden({{"step_size", 0.5}, {"quadratic_size", 0.4}}, 0.01), {"lopsided", "twin"});
  const auto sets = wrong.Sets();
  const auto right = sets.find({"quadratic", "step"});
  ASSERT_NE(right, sets.end());
  // The law is linear: the first start is the answer.
  const Vector& start = right->second.front();
  EXPECT_NEAR(start[wrong.problem.Index("step_size")], 0.5, 0.02);
  EXPECT_NEAR(start[wrong.problem.Index("quadratic_size")], 0.4, 0.02);
  EXPECT_NEAR(start[wrong.problem.Index("gain")], 2, 0.02);
  EXPECT_EQ(start[wrong.problem.Index("twin_size")], 0);
  EXPECT_EQ(start[wrong.problem.Index("lopsided_left")], 0);
}

TEST(ImitatingSets, DifferFromTheCausesInMoreThanOneAndAreNoPartOfThem) {
  const Modelled wrong(Hidden({{"step_size", 0.5}, {"quadratic_size", 0.4}}, 0.01), {"lopsided", "twin"});
  const EffectNames keys = wrong.Keys();
  EXPECT_THAT(keys, Not(Contains("lopsided+step")));
  EXPECT_THAT(keys, Not(Contains("quadratic+twin")));
  EXPECT_THAT(keys, Not(Contains("lopsided")));
  EXPECT_LE(keys.size(), 6U);
}

TEST(ImitatingSets, ThereAreNoneWhereNothingElseDoesTheSame) {
  EXPECT_THAT(
      Modelled(Hidden({{"drift_size", 0.5}, {"quadratic_size", 0.4}}, 0.01), {"drift", "quadratic"}).Keys(),
      IsEmpty());
}

TEST(ImitatingSets, ThereAreNoneOfASingleCause) {
  EXPECT_THAT(Modelled(Hidden({{"step_size", 0.5}}, 0.01), {"twin"}).Keys(), IsEmpty());
}

TEST(ImitatingSets, ASignThatAnEffectCannotHaveIsNotTaken) {
  // quadratic_size is at least 0.
  const Modelled wrong(Hidden({{"step_size", 0.5}, {"lopsided_size", -0.4}, {"lopsided_left", -0.4}}, 0.01),
                       {"lopsided", "twin"});
  for (const auto& [names, starts] : wrong.Sets()) EXPECT_THAT(names, Not(Contains("quadratic")));
}

TEST(LinearisedModel, AParameterOnItsBoundMayLeaveItWithOtherCauses) {
  FitRequest request;
  request.bounds = {{"gain", {2.5, 10}}};
  request.start = {{"gain", 3}};
  const Modelled held(Hidden({{"step_size", 0.5}}, 0.01), {"step"}, request);
  const int gain = held.problem.Index("gain");
  ASSERT_EQ(held.model.point[gain], 2.5);
  LinearisedModel linearised(held.problem, held.candidates, held.model, held.nulls);
  ASSERT_EQ(ErrorOf(linearised.Linearise()), "");
  const auto& free = held.model.setup->free;
  const auto v = std::find(free.begin(), free.end(), gain) - free.begin();
  EXPECT_EQ(linearised.base().col(v).norm(), 0);
  EXPECT_GT(linearised.BaseWithout({}).col(v).norm(), 0);
}

}  // namespace
}  // namespace sinew::diagnosis
