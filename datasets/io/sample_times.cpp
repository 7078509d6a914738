#include "datasets/io/sample_times.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace sinew {
namespace {

constexpr double kRoundingSlack = 1e-6;  // of a unit: decimal fractions are not exact in binary

struct UniformGrid {
  double start_s = 0;
  double rate_Hz = 0;
};

class RoundedTimes {
 public:
  explicit RoundedTimes(const PrintedTimes& printed) : printed_(printed), unit_(printed.last_digit_s) {}

  // Nothing if the times need no rebuilding, or no uniform grid explains them.
  [[nodiscard]] std::optional<UniformGrid> FindGrid() const {
    constexpr std::size_t kMinimum = 3;
    if (size() < kMinimum || !(unit_ > 0) || !StepsLookRounded()) return std::nullopt;
    if (printed_.rate_Hz) {
      if (const auto grid = GridOfRate(*printed_.rate_Hz, unit_)) return grid;
    }
    const double span = time(size() - 1) - time(0);
    if (span <= unit_) return std::nullopt;
    const auto periods = static_cast<double>(index(size() - 1) - index(0));
    const double slowest = periods / (span + unit_);
    const double fastest = periods / (span - unit_);
    if (const auto grid = RoundestGrid(slowest, fastest)) return grid;
    return GridOfRate(1 / BestPeriod(1 / fastest, 1 / slowest), unit_ / 2);
  }

  [[nodiscard]] std::vector<double> On(const UniformGrid& grid) const {
    std::vector<double> rebuilt(size());
    // Counted from time zero where the start is a whole number of periods, so that 60 samples at 60 Hz end at
    // 1 exactly.
    const double first = std::round(grid.start_s * grid.rate_Hz);
    const bool whole = first / grid.rate_Hz == grid.start_s;
    for (std::size_t i = 0; i < size(); ++i) {
      const auto steps = static_cast<double>(index(i) - index(0));
      rebuilt[i] = whole ? (first + steps) / grid.rate_Hz : grid.start_s + steps / grid.rate_Hz;
    }
    return rebuilt;
  }

 private:
  [[nodiscard]] std::size_t size() const { return printed_.time_s.size(); }
  [[nodiscard]] double time(std::size_t i) const { return printed_.time_s[i]; }
  [[nodiscard]] long index(std::size_t i) const {
    return printed_.sample_index.empty() ? static_cast<long>(i) : printed_.sample_index[i];
  }

  // Whether steps, counted in units of the last decimal, differ as rounding makes them differ.
  [[nodiscard]] bool StepsLookRounded() const {
    constexpr double kLargestCount = 9e15;  // counts above it are not exact
    double shortest = kLargestCount;
    double longest = -kLargestCount;
    for (std::size_t i = 0; i + 1 < size(); ++i) {
      if (!(std::abs(time(i + 1)) < kLargestCount * unit_)) return false;
      const double step = (time(i + 1) - time(i)) / static_cast<double>(index(i + 1) - index(i));
      shortest = std::min(shortest, step / unit_);
      longest = std::max(longest, step / unit_);
    }
    constexpr double kSameStep = 0.01;
    constexpr double kMaxRoundingChanges = 2;
    if (shortest < 0 || longest - shortest < kSameStep || longest - shortest > kMaxRoundingChanges)
      return false;

    const double mean =
        (time(size() - 1) - time(0)) / static_cast<double>(index(size() - 1) - index(0)) / unit_;
    constexpr double kUnmistakable = 2;  // units per step: a missing sample would then break the grid
    if (mean >= kUnmistakable) return true;
    std::map<long, std::size_t> occurrences;  // of each step, in units
    std::size_t most = 0;
    for (std::size_t i = 0; i + 1 < size(); ++i) {
      most = std::max(most, ++occurrences[std::lround((time(i + 1) - time(i)) / unit_)]);
    }
    const std::size_t rarer = size() - 1 - most;
    constexpr std::size_t kOften = 3;
    constexpr std::size_t kOneIn = 20;
    return rarer >= std::max(kOften, size() / kOneIn);
  }

  struct Offsets {
    double lowest;
    double highest;
  };

  [[nodiscard]] Offsets OffsetsAt(double period) const {
    Offsets offsets{time(0), time(0)};
    for (std::size_t i = 1; i < size(); ++i) {
      const double offset = time(i) - static_cast<double>(index(i) - index(0)) * period;
      offsets.lowest = std::min(offsets.lowest, offset);
      offsets.highest = std::max(offsets.highest, offset);
    }
    return offsets;
  }

  // The grid of this rate that stays within `tolerance` of every time; of all its starts a whole number of
  // periods first, then the printed start, then the middle.
  [[nodiscard]] std::optional<UniformGrid> GridOfRate(double rate, double tolerance) const {
    if (!(rate > 0) || !std::isfinite(rate)) return std::nullopt;
    const Offsets offsets = OffsetsAt(1 / rate);
    const double slack = tolerance + kRoundingSlack * unit_;
    auto fits = [&](double start) {
      return offsets.highest - start <= slack && start - offsets.lowest <= slack;
    };
    const double middle = (offsets.lowest + offsets.highest) / 2;
    for (const double start : {std::round(middle * rate) / rate, time(0), middle}) {
      if (fits(start)) return UniformGrid{start, rate};
    }
    return std::nullopt;
  }

  [[nodiscard]] std::optional<UniformGrid> RoundestGrid(double slowest, double fastest) const {
    for (const double step : {1000.0, 500.0, 100.0, 50.0, 20.0, 10.0, 5.0, 1.0, 0.5, 0.1}) {
      const double rate = std::round((slowest + fastest) / 2 / step) * step;
      if (rate < slowest || rate > fastest) continue;
      if (const auto grid = GridOfRate(rate, unit_ / 2)) return grid;
    }
    return std::nullopt;
  }

  // The spread of the offsets is a convex function of the period: golden-section search (Kiefer 1953).
  [[nodiscard]] double BestPeriod(double shortest, double longest) const {
    constexpr double kGolden = 0.6180339887498949;
    constexpr int kSections = 60;  // 0.618^60 < 1e-12 of the interval
    auto spread = [&](double period) {
      const Offsets offsets = OffsetsAt(period);
      return offsets.highest - offsets.lowest;
    };
    double left = longest - kGolden * (longest - shortest);
    double right = shortest + kGolden * (longest - shortest);
    double left_spread = spread(left);
    double right_spread = spread(right);
    for (int i = 0; i < kSections; ++i) {
      if (left_spread <= right_spread) {
        longest = right;
        right = left;
        right_spread = left_spread;
        left = longest - kGolden * (longest - shortest);
        left_spread = spread(left);
      } else {
        shortest = left;
        left = right;
        left_spread = right_spread;
        right = shortest + kGolden * (longest - shortest);
        right_spread = spread(right);
      }
    }
    return (shortest + longest) / 2;
  }

  const PrintedTimes& printed_;
  double unit_;
};

}  // namespace

Result<std::vector<double>> UsableTimes(const std::string& file, const PrintedTimes& printed,
                                        std::vector<std::string>& notes) {
  const std::vector<double>& time = printed.time_s;
  for (std::size_t i = 0; i < time.size(); ++i) {
    if (!std::isfinite(time[i])) return FailAt(file, printed.lines[i], "the time is not a number");
  }
  const RoundedTimes rounded(printed);
  if (const auto grid = rounded.FindGrid()) {
    notes.push_back(
        fmt::format("{}: times are rounded to {} s; they were rebuilt at {:.10g} Hz from {:.10g} s", file,
                    fmt::format("{:.3g}", printed.last_digit_s), grid->rate_Hz, grid->start_s));
    return rounded.On(*grid);
  }
  for (std::size_t i = 1; i < time.size(); ++i) {
    if (time[i] <= time[i - 1]) {
      return FailAt(file, printed.lines[i], "time {} s does not increase, the row before is at {} s", time[i],
                    time[i - 1]);
    }
  }
  return time;
}

}  // namespace sinew
