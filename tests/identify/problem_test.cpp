#include "identify/problem.h"

#include <gtest/gtest.h>

#include "tests/identify/support/toy_problem.h"

namespace sinew {
namespace {

TEST(Problem, DeclaresNothingUnlessItSaysSo) {
  const toy::ToyProblem problem({toy::MakeParameter("a", 0, 1, 0.25)}, {}, {});
  EXPECT_TRUE(problem.effects().empty());
  EXPECT_TRUE(problem.ports().empty());
  EXPECT_TRUE(problem.constraints().empty());
  Hdf5Node details;
  EXPECT_TRUE(problem.WriteDetails(RestPoint(problem), details));
  EXPECT_TRUE(details.children.empty());
}

TEST(Problem, RestPointHoldsStartsAndNulls) {
  Parameter effect = toy::MakeParameter("drag", 0, 1, 0.5, ParameterKind::kEffect);
  effect.null_value = 0.125;
  const toy::ToyProblem problem({toy::MakeParameter("a", 0, 1, 0.25), effect,
                                 toy::MakeParameter("initial", -1, 1, -0.5, ParameterKind::kNuisance)},
                                {}, {});
  EXPECT_EQ(RestPoint(problem), toy::Values({0.25, 0.125, -0.5}));
}

}  // namespace
}  // namespace sinew
