#include "problems/registry.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "identify/least_squares.h"
#include "problems/contact/laboratory/synthesis.h"

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

// A diagnosis begins at the answer of `identify`, value by value: both must mean the same.
TEST(ProblemRegistry, ContactWithErrorsOfTheMotionIsTheSameBehindSensors) {
  SynthesisRequest request;
  request.set = {{"person", 1}, {"encoders", 1}, {"train", 1}, {"validate", 1}};
  const Dataset data = SynthesizeContact(request).value();
  std::string text = data.files.at("contact.yaml");
  text.insert(text.find("  regions:"), "  motion_errors: {}\n");
  const auto settings = YamlReader::Parse(text, "contact.yaml").value();
  const ProblemEntry& entry = **FindProblem("contact");
  const auto fitted = entry.bind(data, settings, false).value();
  const auto diagnosed = entry.bind(data, settings, true).value();
  ASSERT_LT(fitted.problem->parameters().size(), diagnosed.problem->parameters().size());
  const auto values = [](const BoundProblem& bound) {
    const Problem& problem = *bound.problem;
    const FitSetup setup = MakeFitSetup(problem, {}).value();
    const LeastSquares fit(problem, setup);
    Vector parameters = setup.rest;
    for (const int index : setup.free) {
      if (setup.parameters[static_cast<std::size_t>(index)].kind == ParameterKind::kNuisance)
        parameters[index] = 0.3 * std::cos(index);
    }
    auto workspace = fit.NewWorkspace();
    Vector residuals;
    EXPECT_TRUE(fit.Evaluate(fit.Variables(parameters), workspace, residuals, nullptr));
    return residuals;
  };
  const Vector first = values(fitted);
  ASSERT_EQ(first.size(), values(diagnosed).size());
  EXPECT_LT((first - values(diagnosed)).norm(), 1e-9 * first.norm());
}

}  // namespace
}  // namespace sinew
