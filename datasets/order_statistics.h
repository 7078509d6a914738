// Exact quantiles of values that are visited, not kept: one channel of a recording may be as large as half of
// its file, and copies of it do not fit beside it.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

namespace sinew {

/// Quantiles by a few passes over the same values, which may come in any order. The first pass counts
/// them by the leading bits of their numbers; the following ones look only at those that share the leading
/// bits of a wanted order statistic, until they are few enough to be kept. Takes at most some megabytes,
/// whatever their number.
class QuantileSelection {
 public:
  /// @param shares [0, 1] of the values that lie below each quantile
  explicit QuantileSelection(std::vector<double> shares);

  /// One value of a pass. @param value not NaN
  void Add(double value) {
    if (pass_ == 0) {
      ++count_;
      if (!spilled_) {
        kept_.push_back(value);
        if (kept_.size() > kMostKept) Spill();
        return;
      }
      ++buckets_[KeyOf(value) >> kFirstShift];
      return;
    }
    const std::uint64_t key = KeyOf(value);
    for (Group& group : groups_) {
      if (key >> group.shift == group.prefix) {
        AddTo(key, group);
        return;
      }
    }
  }

  /// Ends a pass. @return whether another one is needed
  [[nodiscard]] bool EndPass();

  [[nodiscard]] std::size_t count() const { return count_; }
  /// The quantiles, between order statistics, in the order of the shares; NaN if there were no values.
  [[nodiscard]] std::vector<double> values() const;

 private:
  static constexpr std::size_t kMostKept = 65536;
  static constexpr int kDigit = 16;  // [bits] that a pass tells apart
  static constexpr int kFirstShift = 64 - kDigit;

  // An order statistic that is wanted.
  struct Target {
    std::size_t rank;    // among all values
    std::size_t within;  // among those of its group
    double value = NAN;
  };

  // Values that share their leading bits.
  struct Group {
    int shift;  // the other bits
    std::uint64_t prefix;
    std::uint64_t least = ~std::uint64_t{0};
    std::uint64_t most = 0;
    std::vector<std::uint64_t> keys;   // if they are few
    std::vector<std::size_t> buckets;  // else their numbers by the next bits
    std::vector<std::size_t> targets;
  };

  // Integers in the order of the values.
  static std::uint64_t KeyOf(double value) {
    value += 0.0;  // one zero
    std::uint64_t bits = 0;
    std::memcpy(&bits, &value, sizeof bits);
    return (bits >> 63) != 0 ? ~bits : bits | (std::uint64_t{1} << 63);
  }
  static double ValueOf(std::uint64_t key);
  static void AddTo(std::uint64_t key, Group& group);

  void Spill();
  void SetTargets();
  // The groups of the targets in it, by the numbers of its buckets.
  void Divide(const std::vector<std::size_t>& buckets, int shift, std::uint64_t prefix,
              std::vector<std::size_t> targets, std::vector<Group>& groups);

  std::vector<double> shares_;
  std::size_t count_ = 0;
  int pass_ = 0;
  bool spilled_ = false;
  std::vector<double> kept_;
  std::vector<std::size_t> buckets_;
  std::vector<Target> targets_;  // two of each share: at and next to its place
  std::vector<Group> groups_;
};

/// Quantiles of the values that `visit(add)` passes to add(double), the same ones at each of several calls.
/// @return as QuantileSelection::values()
template <class Visit>
[[nodiscard]] std::vector<double> QuantilesOf(const std::vector<double>& shares, const Visit& visit) {
  QuantileSelection selection(shares);
  do {
    visit([&](double value) { selection.Add(value); });
  } while (selection.EndPass());
  return selection.values();
}

template <class Visit>
[[nodiscard]] double QuantileOf(double share, const Visit& visit) {
  return QuantilesOf({share}, visit).front();
}

/// Quantiles of the values that are not NaN or infinite.
[[nodiscard]] std::vector<double> FiniteQuantiles(const std::vector<double>& values,
                                                  const std::vector<double>& shares);

[[nodiscard]] std::size_t CountFinite(const std::vector<double>& values);

/// Robust deviation, as RobustDeviation() tells, of what `visit(add)` adds.
template <class Visit>
[[nodiscard]] double RobustDeviationOf(const Visit& visit) {
  constexpr double kNormal = 1.4826;  // 1 / (upper quartile of the standard normal)
  const double middle = QuantileOf(0.5, visit);
  return kNormal *
         QuantileOf(0.5, [&](auto add) { visit([&](double value) { add(std::abs(value - middle)); }); });
}

}  // namespace sinew
