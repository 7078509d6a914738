#include "base/digest.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <vector>

namespace sinew {
namespace {

Digest::Value Of(const std::vector<double>& numbers) {
  return Digest().Add(numbers.data(), numbers.size()).value();
}

TEST(DigestTest, DependsOnEveryBitAndOnTheOrder) {
  std::set<Digest::Value> values;
  std::size_t added = 0;
  const auto expect_new = [&](const std::vector<double>& numbers) {
    EXPECT_TRUE(values.insert(Of(numbers)).second);
    ++added;
  };
  for (const double number : {0.0, -0.0, 1.0, std::nextafter(1.0, 2.0), -1.0, std::nan("")})
    expect_new({number});
  expect_new({});
  expect_new({1, 2});
  expect_new({2, 1});
  expect_new({1, 2, 0});
  EXPECT_EQ(values.size(), added);
  EXPECT_EQ(Of({1, 2}), Of({1, 2}));
}

TEST(DigestTest, NeighbouringTextsAreNotConfused) {
  const auto of = [](const std::string& a, const std::string& b) { return Digest().Add(a).Add(b).value(); };
  EXPECT_NE(of("ab", "c"), of("a", "bc"));
  EXPECT_NE(of("", "a"), of("a", ""));
  EXPECT_NE(of("eight..A", ""), of("eight..B", ""));
}

TEST(DigestTest, IsReadBackFromItsDigits) {
  const Digest::Value value = Digest().Add(1.5).value();
  Digest::Value read{};
  EXPECT_EQ(ToHex(value).size(), 32U);
  ASSERT_TRUE(FromHex(ToHex(value), read));
  EXPECT_EQ(read, value);
  for (const char* wrong : {"", "12", "0123456789abcdef0123456789abcdeg", "0123456789ABCDEF0123456789ABCDEF"})
    EXPECT_FALSE(FromHex(wrong, read)) << wrong;
}

}  // namespace
}  // namespace sinew
