#include "problems/registry.h"

#include <gtest/gtest.h>

#include <set>

namespace sinew {
namespace {

TEST(ProblemRegistry, EveryEntryIsComplete) {
  std::set<std::string> names;
  for (const ProblemEntry& entry : ProblemRegistry()) {
    EXPECT_TRUE(names.insert(entry.name).second) << entry.name << " stands there twice";
    EXPECT_FALSE(entry.description.empty()) << entry.name;
    EXPECT_FALSE(entry.channels.empty()) << entry.name;
    EXPECT_FALSE(entry.experiment().empty()) << entry.name;
    EXPECT_TRUE(CheckParameters(entry.parameters())) << entry.name;
  }
}

TEST(ProblemRegistry, FindsByNameOrSuggests) {
  for (const ProblemEntry& entry : ProblemRegistry()) {
    const auto found = FindProblem(entry.name);
    ASSERT_TRUE(found);
    EXPECT_EQ(*found, &entry);
  }
  const auto missing = FindProblem("contcat");
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().message, "problem 'contcat' does not exist; did you mean 'contact'?");
}

TEST(ProblemRegistry, UnknownSectionsOfTheSettingsAreErrors) {
  for (const ProblemEntry& entry : ProblemRegistry()) {
    const auto settings = YamlReader::Parse(entry.name + ": {}\nsolvers: {}\n", "s.yaml");
    ASSERT_TRUE(settings);
    const auto bound = entry.bind({}, *settings, false);
    ASSERT_FALSE(bound) << entry.name;
    EXPECT_EQ(bound.error().message.rfind("s.yaml:2: unknown key 'solvers'", 0), 0U) << bound.error().message;
  }
}

}  // namespace
}  // namespace sinew
