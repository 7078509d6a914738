#include "problems/own_model.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>

#include "tests/identify/support/error_of.h"
#include "tests/problems/support/spring.h"

namespace sinew {
namespace {

using testing::HasSubstr;

YamlReader Settings(const std::string& text) {
  return YamlReader::Parse(text, "spring.yaml").value();
}

TEST(OwnModel, IsBoundBareOrSeenThroughItsSensors) {
  const Dataset data = SpringData();
  const auto bare = BindModel<Spring>(data, false);
  const auto seen = BindModel<Spring>(data);
  ASSERT_TRUE(bare && seen);
  EXPECT_EQ((*bare)->effects().size(), 1U);
  EXPECT_GT((*seen)->effects().size(), 10U);
}

TEST(OwnModel, AClassThatTakesNoSettingsRefusesThem) {
  const ProblemEntry entry = ModelEntry<Spring>("spring", "a spring");
  EXPECT_EQ(entry.description, "a spring");
  EXPECT_EQ(ErrorOf(entry.bind(SpringData(), Settings("spring: {}"), false)), "");
  EXPECT_THAT(ErrorOf(entry.bind(SpringData(), Settings("spring: {mass: 3}"), false)), HasSubstr("mass"));
}

/// Reads a setting.
class WithSettings final : public OdeProblem<WithSettings, 1> {
 public:
  WithSettings(const Dataset& data, const YamlReader& settings) : OdeProblem(data) {
    const auto section = settings.At("spring");
    const auto top = section ? section->NumberOr("top", 1) : Result<double>(1);
    parameter("top", "m").bounds(0, 10).start(*top);
    observe("position", state(0));
  }
  template <class T>
  void derivative(const Values<T>&, double, const State<T>&, State<T>& dx) const {
    dx[0] = T(0);
  }
};

TEST(OwnModel, SettingsReachAClassThatTakesThem) {
  const auto bound =
      ModelEntry<WithSettings>("spring").bind(SpringData(), Settings("spring: {top: 7}"), false);
  ASSERT_TRUE(bound) << bound.error().message;
  EXPECT_EQ(bound->problem->parameters()[0].start, 7);
}

class Throws final : public OdeProblem<Throws, 1> {
 public:
  explicit Throws(const Dataset& data) : OdeProblem(data) { throw std::runtime_error("no licence"); }
  template <class T>
  void derivative(const Values<T>&, double, const State<T>&, State<T>&) const {}
};

TEST(OwnModel, AConstructorThatThrowsIsAnError) {
  EXPECT_EQ(ErrorOf(BindModel<Throws>(SpringData())), "the model cannot be made from these data: no licence");
}

class Idle final : public OdeProblem<Idle, 1> {
 public:
  explicit Idle(const Dataset& data) : OdeProblem(data) {
    parameter("idle", "1").bounds(0, 1).start(0.5);
    observe("position", state(0));
  }
  template <class T>
  void derivative(const Values<T>&, double, const State<T>&, State<T>& /*dx*/) const {}  // sets nothing
};

TEST(OwnModel, ARightHandSideThatSetsNothingIsFoundOut) {
  EXPECT_THAT(ErrorOf(BindModel<Idle>(SpringData())), HasSubstr("trial 'one': the state is not finite"));
}

}  // namespace
}  // namespace sinew
