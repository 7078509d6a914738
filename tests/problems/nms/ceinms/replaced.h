// A text with one of its pieces replaced, which it must have.
#pragma once

#include <gtest/gtest.h>

#include <string>

namespace sinew {

inline std::string Replaced(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

}  // namespace sinew
