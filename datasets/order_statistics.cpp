#include "datasets/order_statistics.h"

#include <algorithm>
#include <utility>

namespace sinew {
namespace {

constexpr std::size_t kMostKeys = 200000;  // of a group, that are kept
constexpr std::size_t kBuckets = std::size_t{1} << 16;

double PlaceOf(double share, std::size_t count) {
  return share * static_cast<double>(count - 1);
}

}  // namespace

QuantileSelection::QuantileSelection(std::vector<double> shares) : shares_(std::move(shares)) {}

double QuantileSelection::ValueOf(std::uint64_t key) {
  const std::uint64_t bits = (key >> 63) != 0 ? key & ~(std::uint64_t{1} << 63) : ~key;
  double value = 0;
  std::memcpy(&value, &bits, sizeof value);
  return value;
}

void QuantileSelection::AddTo(std::uint64_t key, Group& group) {
  group.least = std::min(group.least, key);
  group.most = std::max(group.most, key);
  if (group.buckets.empty()) {
    group.keys.push_back(key);
  } else {
    ++group.buckets[(key >> (group.shift - kDigit)) & (kBuckets - 1)];
  }
}

void QuantileSelection::Spill() {
  spilled_ = true;
  buckets_.assign(kBuckets, 0);
  for (const double value : kept_) ++buckets_[KeyOf(value) >> kFirstShift];
  kept_ = {};
}

void QuantileSelection::SetTargets() {
  for (const double share : shares_) {
    const auto low = static_cast<std::size_t>(PlaceOf(share, count_));
    for (const std::size_t rank : {low, std::min(low + 1, count_ - 1)}) targets_.push_back({rank, rank});
  }
}

void QuantileSelection::Divide(const std::vector<std::size_t>& buckets, int shift, std::uint64_t prefix,
                               std::vector<std::size_t> targets, std::vector<Group>& groups) {
  std::sort(targets.begin(), targets.end(),
            [&](std::size_t a, std::size_t b) { return targets_[a].within < targets_[b].within; });
  auto next = targets.begin();
  std::size_t before = 0;
  for (std::size_t b = 0; b < buckets.size() && next != targets.end(); ++b) {
    const std::size_t end = before + buckets[b];
    Group group{shift, (prefix << kDigit) | b, ~std::uint64_t{0}, 0, {}, {}, {}};
    for (; next != targets.end() && targets_[*next].within < end; ++next) {
      targets_[*next].within -= before;
      group.targets.push_back(*next);
    }
    before = end;
    if (group.targets.empty()) continue;
    if (shift == 0) {  // all bits are known
      for (const std::size_t t : group.targets) targets_[t].value = ValueOf(group.prefix);
      continue;
    }
    if (buckets[b] > kMostKeys) group.buckets.assign(kBuckets, 0);
    groups.push_back(std::move(group));
  }
}

bool QuantileSelection::EndPass() {
  if (count_ == 0) return false;
  std::vector<Group> next;
  if (pass_ == 0) {
    SetTargets();
    if (!spilled_) {
      for (Target& target : targets_) {
        const auto at = kept_.begin() + static_cast<std::ptrdiff_t>(target.rank);
        std::nth_element(kept_.begin(), at, kept_.end());
        target.value = *at;
      }
      return false;
    }
    std::vector<std::size_t> all(targets_.size());
    for (std::size_t t = 0; t < all.size(); ++t) all[t] = t;
    Divide(buckets_, kFirstShift, 0, all, next);
    buckets_ = {};
  } else {
    for (Group& group : groups_) {
      const bool one_value = group.least == group.most;
      if (!one_value && !group.buckets.empty()) {
        Divide(group.buckets, group.shift - kDigit, group.prefix, group.targets, next);
        continue;
      }
      for (const std::size_t t : group.targets) {
        std::uint64_t key = group.least;
        if (!one_value) {
          const auto at = group.keys.begin() + static_cast<std::ptrdiff_t>(targets_[t].within);
          std::nth_element(group.keys.begin(), at, group.keys.end());
          key = *at;
        }
        targets_[t].value = ValueOf(key);
      }
    }
  }
  groups_ = std::move(next);
  ++pass_;
  return !groups_.empty();
}

std::vector<double> QuantileSelection::values() const {
  std::vector<double> values(shares_.size(), NAN);
  if (count_ == 0) return values;
  for (std::size_t i = 0; i < shares_.size(); ++i) {
    const double place = PlaceOf(shares_[i], count_);
    const auto low = static_cast<std::size_t>(place);
    const double value = targets_[2 * i].value;
    values[i] = low + 1 == count_
                    ? value
                    : value + (place - static_cast<double>(low)) * (targets_[2 * i + 1].value - value);
  }
  return values;
}

std::vector<double> FiniteQuantiles(const std::vector<double>& values, const std::vector<double>& shares) {
  return QuantilesOf(shares, [&](auto add) {
    for (const double value : values) {
      if (std::isfinite(value)) add(value);
    }
  });
}

std::size_t CountFinite(const std::vector<double>& values) {
  return static_cast<std::size_t>(
      std::count_if(values.begin(), values.end(), [](double value) { return std::isfinite(value); }));
}

}  // namespace sinew
