// A digest of what a computation was asked, by which its answer is found again.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>

namespace sinew {

/// 128 bits that depend on every value added and on their order, to the last bit: 0 and -0 differ, and every
/// NaN is itself. Two lanes of 64 bits, each multiplied and rotated per word (after Appleby, MurmurHash3,
/// 2011). Not for use against people who look for collisions: by chance, 1e9 questions have one with a
/// probability of 1e-20.
class Digest {
 public:
  using Value = std::array<std::uint64_t, 2>;

  Digest& Add(std::uint64_t word);
  Digest& Add(double number);
  /// The length first, so that neighbouring texts cannot be confused.
  Digest& Add(const std::string& text);
  /// The count first.
  Digest& Add(const double* numbers, std::size_t count);

  [[nodiscard]] Value value() const;

 private:
  std::uint64_t first_ = 0x9ae16a3b2f90404f;
  std::uint64_t second_ = 0xc3a5c85c97cb3127;
  std::uint64_t words_ = 0;
};

/// 32 hexadecimal digits, and back. @return false: not such digits
[[nodiscard]] std::string ToHex(const Digest::Value& value);
[[nodiscard]] bool FromHex(const std::string& hex, Digest::Value& value);

}  // namespace sinew
