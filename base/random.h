// Random numbers that are the same on every machine and standard library: a seed names one sequence for good.
#pragma once

#include <cstdint>
#include <random>

namespace sinew {

/// Uniform and normal numbers from a 64-bit Mersenne twister (Matsumoto, Nishimura 1998), whose output the
/// standard fixes; the distributions of <random> it leaves open, so they are ours. Passed by reference, never
/// global.
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}

  /// Uniform in [0, 1), 53 random bits.
  double Uniform() { return static_cast<double>(engine_() >> 11) * 0x1.0p-53; }
  double Uniform(double lower, double upper) { return lower + (upper - lower) * Uniform(); }

  /// Standard normal, polar method (Marsaglia, Bray 1964).
  double Normal();

  /// Uniform over 0 .. count-1; count >= 1. The bias of the modulus is below count / 2^64.
  std::uint64_t Index(std::uint64_t count) { return engine_() % count; }

  /// A seed for an independent stream: stream i of the same parent seed is always the same (SplitMix64).
  static std::uint64_t StreamSeed(std::uint64_t seed, std::uint64_t stream);

 private:
  std::mt19937_64 engine_;
  bool has_spare_ = false;
  double spare_ = 0;
};

}  // namespace sinew
