#include "base/digest.h"

#include <fmt/format.h>

#include <cstring>

namespace sinew {
namespace {

constexpr std::uint64_t kFirst = 0x87c37b91114253d5;
constexpr std::uint64_t kSecond = 0x4cf5ad432745937f;

std::uint64_t Rotated(std::uint64_t word, int bits) {
  return (word << bits) | (word >> (64 - bits));
}

std::uint64_t Finished(std::uint64_t word) {
  word ^= word >> 33;
  word *= 0xff51afd7ed558ccd;
  word ^= word >> 33;
  word *= 0xc4ceb9fe1a85ec53;
  return word ^ (word >> 33);
}

}  // namespace

Digest& Digest::Add(std::uint64_t word) {
  first_ ^= Rotated(word * kFirst, 31) * kSecond;
  first_ = Rotated(first_, 27) * 5 + 0x52dce729;
  second_ ^= Rotated(word * kSecond, 33) * kFirst;
  second_ = Rotated(second_, 31) * 5 + 0x38495ab5;
  ++words_;
  return *this;
}

Digest& Digest::Add(double number) {
  std::uint64_t bits = 0;
  static_assert(sizeof bits == sizeof number);
  std::memcpy(&bits, &number, sizeof bits);
  return Add(bits);
}

Digest& Digest::Add(const std::string& text) {
  Add(static_cast<std::uint64_t>(text.size()));
  for (std::size_t at = 0; at < text.size(); at += 8) {
    std::uint64_t word = 0;
    for (std::size_t i = at; i < text.size() && i < at + 8; ++i)
      word = (word << 8) | static_cast<unsigned char>(text[i]);
    Add(word);
  }
  return *this;
}

Digest& Digest::Add(const double* numbers, std::size_t count) {
  Add(static_cast<std::uint64_t>(count));
  for (std::size_t i = 0; i < count; ++i) Add(numbers[i]);
  return *this;
}

Digest::Value Digest::value() const {
  std::uint64_t a = first_ ^ words_;
  std::uint64_t b = second_ ^ words_;
  a += b;
  b += a;
  a = Finished(a);
  b = Finished(b);
  a += b;
  return {a, b + a};
}

std::string ToHex(const Digest::Value& value) {
  return fmt::format("{:016x}{:016x}", value[0], value[1]);
}

bool FromHex(const std::string& hex, Digest::Value& value) {
  if (hex.size() != 32) return false;
  value = {0, 0};
  for (std::size_t i = 0; i < hex.size(); ++i) {
    const char c = hex[i];
    const int digit = c >= '0' && c <= '9' ? c - '0' : c >= 'a' && c <= 'f' ? c - 'a' + 10 : -1;
    if (digit < 0) return false;
    value[i / 16] = value[i / 16] * 16 + static_cast<std::uint64_t>(digit);
  }
  return true;
}

}  // namespace sinew
