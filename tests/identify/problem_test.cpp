#include "identify/problem.h"

#include <gtest/gtest.h>

#include "tests/identify/support/toy_problem.h"

namespace sinew {
namespace {

TEST(UnknownTerm, InterpolatesBetweenKnotsAndIsConstantBeyond) {
  const UnknownTerm term{0, 0, {-1, 0, 2}, toy::Values({3, 5, -1})};
  EXPECT_EQ(term.Value(-7), 3);
  EXPECT_EQ(term.Value(-1), 3);
  EXPECT_EQ(term.Value(-0.5), 4);
  EXPECT_EQ(term.Value(0), 5);
  EXPECT_EQ(term.Value(1), 2);
  EXPECT_EQ(term.Value(2), -1);
  EXPECT_EQ(term.Value(9), -1);
}

TEST(Problem, DeclaresNothingUnlessItSaysSo) {
  const toy::ToyProblem problem({toy::MakeParameter("a", 0, 1, 0.25)}, {}, {});
  EXPECT_TRUE(problem.effects().empty());
  EXPECT_TRUE(problem.ports().empty());
  EXPECT_TRUE(problem.constraints().empty());
  Hdf5Node details;
  EXPECT_TRUE(problem.Describe(RestPoint(problem), details));
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
