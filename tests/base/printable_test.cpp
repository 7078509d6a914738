#include "base/printable.h"

#include <gtest/gtest.h>

namespace sinew {
namespace {

TEST(Printable, LeavesTextAlone) {
  const std::string text = "Kraft: 3 N·m² – größer\n日本 🙂 'a' \\";
  EXPECT_EQ(Printable(text), text);
  EXPECT_EQ(PrintableLine("a b"), "a b");
  EXPECT_EQ(Printable(""), "");
}

TEST(Printable, HasNoControlCharacters) {
  EXPECT_EQ(Printable("\x1b[2J\x07\r\x7f\t"), "\\x1b[2J\\x07\\x0d\\x7f\\x09");
  EXPECT_EQ(Printable(std::string("\0", 1)), "\\x00");
  EXPECT_EQ(Printable("\xc2\x9b"), "\\x9b") << "C1 as UTF-8";
  EXPECT_EQ(Printable("\xe2\x80\xae"), "\\u202e") << "writes from right to left";
  EXPECT_EQ(PrintableLine("a\nb\tc"), "a\\nb\\tc");
}

TEST(Printable, HasNoBytesThatAreNotUtf8) {
  EXPECT_EQ(Printable("\x9b"), "\\x9b");
  EXPECT_EQ(Printable("a\xe2\x80"), "a\\xe2\\x80") << "cut off";
  EXPECT_EQ(Printable("\xc0\x9b"), "\\xc0\\x9b") << "overlong";
  EXPECT_EQ(Printable("\xe0\x82\x9b"), "\\xe0\\x82\\x9b") << "overlong";
  EXPECT_EQ(Printable("\xed\xa0\x80"), "\\xed\\xa0\\x80") << "surrogate";
  EXPECT_EQ(Printable("\xf4\x90\x80\x80"), "\\xf4\\x90\\x80\\x80") << "beyond the last character";
}

TEST(Printable, JsonMeansTheSame) {
  EXPECT_EQ(PrintableJson("{\n  \"a\": \"\xc2\x9b\x7f\"\n}"), "{\n  \"a\": \"\\u009b\\u007f\"\n}");
}

}  // namespace
}  // namespace sinew
