#include <gtest/gtest.h>

#include <set>

#include "identify/solvers/solver.h"

namespace sinew {
namespace {

std::string ErrorOf(const std::string& name, const SolverOptions& options = {}) {
  const auto solver = MakeSolver(name, options);
  return solver ? "" : solver.error().message;
}

TEST(SolverRegistry, EveryEntryCanBeMade) {
  std::set<std::string> names;
  for (const SolverEntry& entry : SolverRegistry()) {
    EXPECT_EQ(ErrorOf(entry.name), "");
    EXPECT_TRUE(names.insert(entry.name).second) << entry.name;
    EXPECT_FALSE(entry.description.empty()) << entry.name;
  }
}

TEST(SolverRegistry, EveryNloptNameCanBeMade) {
  EXPECT_EQ(ErrorOf("nlopt:LN_NEWUOA_BOUND"), "");
}

TEST(SolverRegistry, UnknownNamesAreErrorsWithTheClosestName) {
  EXPECT_EQ(ErrorOf("cers"), "solver 'cers' does not exist; did you mean 'ceres'?");
  EXPECT_EQ(ErrorOf("sa+cers"), "solver 'cers' does not exist; did you mean 'ceres'?");
  EXPECT_EQ(ErrorOf("nlopt:LN_BOBYQUA"),
            "solver 'nlopt:LN_BOBYQUA': NLopt has no such algorithm; did you mean 'LN_BOBYQA'?");
  EXPECT_NE(ErrorOf("").find("solver '' does not exist"), std::string::npos);
}

TEST(SolverRegistry, EmptyLinksAreNamed) {
  EXPECT_EQ(ErrorOf("sa+"), "solver chain 'sa+' has an empty link, expected names joined by '+'");
  EXPECT_EQ(ErrorOf("+"), "solver chain '+' has an empty link, expected names joined by '+'");
}

TEST(SolverRegistry, OptionsAreChecked) {
  SolverOptions options;
  options.threads = 0;
  EXPECT_EQ(ErrorOf("sa", options), "threads: 0, expected at least 1");
  options = {};
  options.starts = 0;
  EXPECT_EQ(ErrorOf("sa", options), "starts of a multi-start: 0, expected at least 1");
  options = {};
  options.cost_tolerance = 0;
  EXPECT_EQ(ErrorOf("sa", options), "cost tolerance: 0, expected between 0 and 1");
}

TEST(Termination, NamesAreUniqueAndConvergedIsUsable) {
  std::set<std::string> names;
  for (int i = 0; i <= static_cast<int>(Termination::kNoPrediction); ++i) {
    const Stop stop{static_cast<Termination>(i), ""};
    EXPECT_TRUE(names.insert(ToString(stop.kind)).second) << ToString(stop.kind);
    EXPECT_TRUE(!stop.converged() || stop.usable()) << ToString(stop.kind);
  }
  EXPECT_EQ(names.count("?"), 0u);
}

}  // namespace
}  // namespace sinew
