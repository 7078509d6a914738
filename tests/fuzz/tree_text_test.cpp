#include "tests/fuzz/tree_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace sinew::fuzz {
namespace {

TEST(TreeText, IsTheSameAfterATurn) {
  Hdf5Node root;
  root.attributes["schema"] = std::string("a\nb\\c");
  root.At("g").attributes["number"] = 2.0;
  root.At("g").attributes["integer"] = std::int64_t{-3};
  root.At("g/vector").SetVector({0.1, 1e300, -2});
  root.At("g/scalar").SetScalar(4);
  root.At("g/matrix").SetMatrix(1, 2, {5, 6});
  root.At("text").data = std::string("one\ntwo");
  root.At("texts").data = std::vector<std::string>{"p", "", "q"};
  root.At("empty");
  const Hdf5Node again = ToTree(ToText(root));
  EXPECT_EQ(ToText(again), ToText(root));
  EXPECT_EQ(std::get<std::string>(again.attributes.at("schema")), "a\nb\\c");
  EXPECT_EQ(std::get<double>(again.Find("g")->attributes.at("number")), 2.0);
  EXPECT_EQ(std::get<std::int64_t>(again.Find("g")->attributes.at("integer")), -3);
  EXPECT_THAT(again.Find("g/vector")->array()->values, testing::ElementsAre(0.1, 1e300, -2));
  EXPECT_THAT(again.Find("g/matrix")->array()->shape, testing::ElementsAre(1U, 2U));
  EXPECT_TRUE(again.Find("g/scalar")->array()->shape.empty());
  EXPECT_EQ(*again.Find("text")->text(), "one\ntwo");
  EXPECT_THAT(*again.Find("texts")->texts(), testing::ElementsAre("p", "", "q"));
  EXPECT_NE(again.Find("empty"), nullptr);
}

TEST(TreeText, TakesAnything) {
  const Hdf5Node odd = ToTree("a 99999999999 2 = 1\n/ =\n \n@\nb @\nb @x\nb @y \"\nc [\nd 3 = 1\nd/e \"t");
  EXPECT_EQ(odd.Find("a")->array()->values.size(), 4096U);  // 4096 x 2 is too much
  EXPECT_EQ(ToTree(" 1 = 2").array(), nullptr);             // a file is a group
  EXPECT_EQ(odd.Find("d")->array(), nullptr);               // a group now
}

}  // namespace
}  // namespace sinew::fuzz
