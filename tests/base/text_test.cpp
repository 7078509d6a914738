#include "base/text.h"

#include <gtest/gtest.h>

#include <cmath>

namespace sinew {
namespace {

TEST(Text, SplitKeepsEmptyPieces) {
  EXPECT_EQ(Split("a,,b,", ','), (std::vector<std::string_view>{"a", "", "b", ""}));
  EXPECT_EQ(SplitBlanks("  a\t b\r"), (std::vector<std::string_view>{"a", "b"}));
  EXPECT_TRUE(SplitBlanks(" \t").empty());
}

TEST(Text, LinesBecomeOne) {
  EXPECT_EQ(OneLine("\n an exception:\r\n\n  it\twas thrown. \n"), "an exception: it was thrown.");
  EXPECT_EQ(OneLine(" \n"), "");
}

TEST(Text, NumbersMustFillTheWholeText) {
  EXPECT_EQ(ParseNumber(" +1.5e3 "), 1500.0);
  EXPECT_EQ(ParseNumber("-0.25"), -0.25);
  EXPECT_TRUE(std::isnan(*ParseNumber("NaN")));
  EXPECT_FALSE(ParseNumber("1.5x"));
  EXPECT_FALSE(ParseNumber(""));
  EXPECT_FALSE(ParseNumber("1,5"));
  EXPECT_EQ(ParseInteger("42"), 42);
  EXPECT_FALSE(ParseInteger("4.2"));
}

TEST(Text, LongTextsAreLikeNothing) {
  const std::string text(1000000, 'a');
  const std::string other = text + "b";
  EXPECT_FALSE(ClosestName(text, {other}));
  EXPECT_EQ(ClosestName(text, {other, text}), text);
  EXPECT_EQ(ByLikeness("a", {text, "ab"}), "ab, " + text);
}

TEST(Text, SuggestsTheClosestName) {
  const std::vector<std::string> names{"stiffness", "dissipation", "static_friction"};
  EXPECT_EQ(ClosestName("stifness", names), "stiffness");
  EXPECT_EQ(ClosestName("Dissipaton", names), "dissipation");
  EXPECT_FALSE(ClosestName("mass", names));
  EXPECT_EQ(Suggestion("stifness", names), "; did you mean 'stiffness'?");
  EXPECT_EQ(Suggestion("mass", names), "; expected one of stiffness, dissipation, static_friction");
}

}  // namespace
}  // namespace sinew
