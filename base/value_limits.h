// How much a file may hold or announce before it is taken for damaged.
#pragma once

#include <algorithm>
#include <cstddef>

namespace sinew {

constexpr std::size_t kMaxValues = std::size_t{1} << 28;  ///< 2 GiB of doubles
constexpr std::size_t kMostColumns = 20000;  ///< of a table of text, and channels of an import map
constexpr std::size_t kMostXml = std::size_t{1}
                                 << 26U;  ///< [bytes] pugixml takes twenty times as much at worst
constexpr int kDeepestNesting = 32;       ///< of groups, structs or cells

/// The most values that a file of this size can hold: deflate compresses at most 1032 to 1, and a value has
/// at least one byte; values that are not stored have an allowance.
[[nodiscard]] constexpr std::size_t MostValues(std::size_t bytes) {
  constexpr std::size_t kPerByte = 1032;
  constexpr std::size_t kSmallFile = 4096;  // [bytes]
  if (bytes >= kMaxValues / kPerByte) return kMaxValues;
  return std::min(kMaxValues, kPerByte * (bytes + kSmallFile));
}

}  // namespace sinew
