#include "base/yaml_limits.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/yaml_reader.h"

namespace sinew {
namespace {

std::string ErrorOf(const std::string& text) {
  const auto read = YamlReader::Parse(text, "s.yaml");
  return read ? "" : read.error().message;
}

// Ten of the line before on each line: 10^lines values.
std::string Laughs(int lines) {
  std::string text = "l0: &l0 lol\n";
  for (int i = 1; i <= lines; ++i) {
    text += fmt::format("l{0}: &l{0} [", i);
    for (int k = 0; k < 10; ++k) text += fmt::format("{}*l{}", k == 0 ? "" : ", ", i - 1);
    text += "]\n";
  }
  return text;
}

TEST(YamlLimits, OrdinaryAliasesAreRead) {
  const auto read = YamlReader::Parse("a: &a {x: 1, y: [2, 3]}\nb: *a\nc: [*a, *a]\n", "s.yaml");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(*read->At("b")->At("x")->Number(), 1);
  EXPECT_EQ(read->At("c")->Items()->size(), 2U);
  EXPECT_EQ(ErrorOf(Laughs(3)), "");
}

TEST(YamlLimits, AliasesOfAliasesAreRefused) {
  for (const int lines : {9, 60, 400})
    EXPECT_EQ(ErrorOf(Laughs(lines)), "s.yaml:1: its aliases stand for more than 67108864 characters")
        << lines;
}

TEST(YamlLimits, ManyAliasesOfALongTextAreRefused) {
  std::string text = "a: &a " + std::string(1000000, 'x') + "\nb: [*a";
  for (int i = 0; i < 100; ++i) text += ", *a";
  EXPECT_EQ(ErrorOf(text + "]\n"), "s.yaml:1: its aliases stand for more than 67108864 characters");
}

TEST(YamlLimits, AnAliasOfItselfIsRefused) {
  for (const char* text : {"a: &a [*a]\n", "&a {b: *a}\n", "a: &a {b: [1, {c: *a}]}\n"})
    EXPECT_EQ(ErrorOf(text), "s.yaml:1: an alias stands within what it stands for") << text;
  // An anchor whose name is used again belongs to what follows.
  EXPECT_EQ(ErrorOf("a: &a 1\nb: &a [2]\nc: *a\n"), "");
  EXPECT_THAT(ErrorOf("a: *b\n"), testing::HasSubstr("is not YAML"));
}

TEST(YamlLimits, SizeAndDepthAreLimited) {
  EXPECT_EQ(ErrorOf(std::string(kMostYaml + 1, ' ')),
            "s.yaml: has 67108865 bytes, expected at most 67108864");
  for (const char bracket : {'[', '{'})
    EXPECT_EQ(ErrorOf(std::string(1000, bracket)), "s.yaml:1: nests deeper than 200 levels");
  std::string indented;
  for (std::size_t i = 0; i < 2000; ++i) indented += std::string(i, ' ') + "a:\n";
  EXPECT_NE(ErrorOf(indented), "");  // yaml-cpp's own limit
}

}  // namespace
}  // namespace sinew
