#include "datasets/check/displaced_stretches.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "base/decompositions.h"
#include "base/linear_algebra.h"
#include "datasets/order_statistics.h"

namespace sinew {
namespace {

constexpr int kStretchOrder = 10;  // of the autoregression
constexpr std::size_t kStretchFewest = 100;
constexpr double kStretchCoarse = 0.12;  // 99th percentile of the increments, of the range
constexpr int kStretchPasses = 4;
constexpr double kStretchOutlier = 4;  // robust deviations of the innovations
constexpr double kStretchRidge = 1e-9;
constexpr double kStretchFaults = 20;      // jumps that a fault may have without moving what is usual
constexpr double kStretchBeyond = 4.5;     // of the 99th percentile over all trials, and the 90th of this one
constexpr double kStretchOfRange = 0.25;   // of the trial's range
constexpr double kStretchAlike = 0.6;      // smaller of the two jumps, of the larger one
constexpr double kStretchLongest = 0.3;    // of the trial
constexpr std::size_t kStretchLeast = 4;   // [samples]
constexpr std::size_t kStretchAround = 3;  // a jump is the largest of so many on each side
constexpr std::size_t kStretchMostSteps = 1000;  // of a trial, the largest, that are paired
constexpr std::size_t kStretchMostTold = 20000;  // samples of a stretch that tell where it is

// A signal less its median.
class Centred {
 public:
  explicit Centred(const std::vector<double>& values) : values_(values) {
    const double middle = FiniteQuantiles(values, {0.5}).front();
    if (std::isfinite(middle)) middle_ = middle;
  }

  [[nodiscard]] std::size_t size() const { return values_.size(); }
  [[nodiscard]] double operator[](std::size_t t) const { return values_[t] - middle_; }

  // Calls use(t, x) for each t from the kStretchOrder-th on; x[0] is the value there, x[-k] the one k before.
  template <class Use>
  void ForEachWindow(const Use& use) const {
    constexpr std::size_t kBlock = 4096;
    std::array<double, kBlock + kStretchOrder> block{};
    for (std::size_t from = 0; from + kStretchOrder < size(); from += kBlock) {
      const std::size_t end = std::min(size(), from + kBlock + kStretchOrder);
      for (std::size_t t = from; t < end; ++t) block[t - from] = (*this)[t];
      for (std::size_t t = from + kStretchOrder; t < end; ++t) use(t, block.data() + (t - from));
    }
  }

  // Calls use(value) for each finite one.
  template <class Use>
  void ForEachFinite(const Use& use) const {
    for (const double v : values_) {
      if (std::isfinite(v - middle_)) use(v - middle_);
    }
  }

  // From the 2nd to the 98th percentile; 0 of fewer than ten.
  [[nodiscard]] double Range() const {
    if (CountFinite(values_) < 10) return 0;
    const auto ends = QuantilesOf({0.02, 0.98}, [&](auto add) { ForEachFinite(add); });
    return ends[1] - ends[0];
  }

 private:
  const std::vector<double>& values_;
  double middle_ = 0;
};

// Each value is predicted by the kStretchOrder values before it.
class Autoregression {
 public:
  // Least squares over all trials, repeated without what is predicted worst.
  explicit Autoregression(const std::vector<Centred>& trials) {
    double limit = INFINITY;
    for (int pass = 0; pass < kStretchPasses; ++pass) {
      if (!Fit(trials, limit)) return;
      if (pass + 1 == kStretchPasses) break;
      limit = kStretchOutlier * 1.4826 * QuantileOf(0.5, [&](auto add) {
                for (const Centred& trial : trials) {
                  trial.ForEachWindow([&](std::size_t, const double* x) {
                    const double e = Innovation(x);
                    if (std::isfinite(e)) add(std::abs(e));
                  });
                }
              });
      if (std::isnan(limit)) return;
    }
    // What a unit step leaves: its innovations.
    step_ = {1};
    for (int k = 0; k < kStretchOrder; ++k) step_.push_back(step_.back() - weights_[k]);
  }

  [[nodiscard]] bool valid() const { return !step_.empty(); }

  // The step at each sample that fits the innovations from there on best, [N]; NaN where there are too few.
  [[nodiscard]] std::vector<double> Steps(const Centred& trial) const {
    // Innovations first; each is replaced once those before it are done.
    std::vector<double> steps(trial.size(), NAN);
    trial.ForEachWindow([&](std::size_t t, const double* x) { steps[t] = Innovation(x); });
    for (std::size_t t = 0; t < steps.size(); ++t) {
      double products = 0;
      double squares = 0;
      for (std::size_t k = 0; k < step_.size() && t + k < steps.size(); ++k) {
        products += step_[k] * steps[t + k];  // NaN next to a gap
        squares += step_[k] * step_[k];
      }
      steps[t] = products / squares;
    }
    return steps;
  }

 private:
  // The weights by the values whose innovations do not exceed the limit.
  bool Fit(const std::vector<Centred>& trials, double limit) {
    std::array<std::array<double, kStretchOrder>, kStretchOrder> products{};  // lower half
    std::array<double, kStretchOrder> right{};
    for (const Centred& trial : trials) {
      trial.ForEachWindow([&](std::size_t, const double* x) {
        const double e = std::isinf(limit) ? 0 : Innovation(x);
        double sum = x[0];
        for (int k = 1; k <= kStretchOrder; ++k) sum += x[-k];
        if (!std::isfinite(sum) || std::abs(e) > limit) return;
        for (std::size_t i = 0; i < kStretchOrder; ++i) {
          const double past = x[-1 - static_cast<std::ptrdiff_t>(i)];
          for (std::size_t j = 0; j <= i; ++j)
            products[i][j] += past * x[-1 - static_cast<std::ptrdiff_t>(j)];
          right[i] += x[0] * past;
        }
      });
    }
    Eigen::MatrixXd gram(kStretchOrder, kStretchOrder);
    for (int i = 0; i < kStretchOrder; ++i) {
      for (int j = 0; j <= i; ++j)
        gram(i, j) = gram(j, i) = products[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)];
    }
    if (!(gram.trace() > 0)) return false;
    gram.diagonal().array() += kStretchRidge * gram.trace() / kStretchOrder;
    const Eigen::VectorXd sums = Eigen::Map<const Eigen::VectorXd>(right.data(), kStretchOrder);
    const Eigen::VectorXd weights = gram.ldlt().solve(sums);
    std::copy(weights.begin(), weights.end(), weights_.begin());
    return true;
  }

  [[nodiscard]] double Innovation(const double* x) const {
    double e = x[0];
    for (int k = 0; k < kStretchOrder; ++k) e -= weights_[static_cast<std::size_t>(k)] * x[-1 - k];
    return e;
  }

  std::array<double, kStretchOrder> weights_{};
  std::vector<double> step_;
};

template <class Add>
void AddSizes(const std::vector<double>& values, const Add& add) {
  for (const double v : values) {
    if (std::isfinite(v)) add(std::abs(v));
  }
}

// Whether the signal is, on the whole, away from what is around by half of the step at least. Stretches that
// are shorter than an oscillation may be anywhere.
bool IsAway(const Centred& x, std::size_t first, std::size_t after, double step) {
  const std::size_t length = after - first;
  if (length < 2 * kStretchOrder) return true;
  const std::size_t stride = 1 + length / kStretchMostTold;
  const auto median = [&](std::size_t from, std::size_t to, std::size_t leave, std::size_t until) {
    return QuantileOf(0.5, [&](auto add) {
      for (std::size_t i = from; i < to; i += stride) {
        if ((i < leave || i >= until) && std::isfinite(x[i])) add(x[i]);
      }
    });
  };
  const double inside = median(first, after, after, after);
  const double around =
      median(first > length ? first - length : 0, std::min(after + length, x.size()), first, after);
  return (inside - around) / step > 0.5;  // false if one of them is not known
}

// Where the steps are largest among their neighbours.
std::vector<std::size_t> Peaks(const std::vector<double>& steps, double least) {
  std::vector<std::size_t> at;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    bool largest = std::abs(steps[i]) >= least;
    const std::size_t from = i > kStretchAround ? i - kStretchAround : 0;
    for (std::size_t j = from; largest && j <= i + kStretchAround && j < steps.size(); ++j)
      largest = !(std::abs(steps[j]) > std::abs(steps[i]));
    if (largest) at.push_back(i);
  }
  return at;
}

// Pairs of opposite steps of like size, the largest first; they do not overlap.
std::vector<std::pair<std::size_t, std::size_t>> Pairs(const Centred& x, const std::vector<double>& steps,
                                                       double least) {
  std::vector<std::size_t> at = Peaks(steps, least);
  const auto size = [&](std::size_t i) { return std::abs(steps[i]); };
  std::stable_sort(at.begin(), at.end(), [&](std::size_t a, std::size_t b) { return size(a) > size(b); });
  if (at.size() > kStretchMostSteps) at.resize(kStretchMostSteps);
  const auto longest = static_cast<std::size_t>(kStretchLongest * static_cast<double>(steps.size()));
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  const auto fits = [&](std::size_t a, std::size_t b) {
    if (b < a + kStretchLeast || b > a + longest || !(steps[a] * steps[b] < 0)) return false;
    const bool overlaps =
        std::any_of(pairs.begin(), pairs.end(), [&](const auto& p) { return a <= p.second && b >= p.first; });
    return !overlaps && IsAway(x, a, b, steps[a]);
  };
  // By their smaller step. Of several of one size the first in time.
  for (std::size_t from = 0, to = 0; from < at.size(); from = to) {
    while (to < at.size() && size(at[to]) == size(at[from])) ++to;
    while (true) {
      std::optional<std::pair<std::size_t, std::size_t>> best;
      for (std::size_t s = from; s < to; ++s) {
        for (std::size_t l = s; l-- > 0 && size(at[s]) >= kStretchAlike * size(at[l]);) {
          const std::pair<std::size_t, std::size_t> pair = std::minmax(at[s], at[l]);
          if ((!best || pair < *best) && fits(pair.first, pair.second)) best = pair;
        }
      }
      if (!best) break;
      pairs.push_back(*best);
    }
  }
  return pairs;
}

}  // namespace

std::vector<Finding> FindDisplacedStretches(const ChannelGroup& group) {
  std::size_t known = 0;
  for (const Signal& signal : group.signals) known += CountFinite(signal.values);
  if (known < kStretchFewest) return {};
  const double fast = QuantileOf(0.99, [&](auto add) {
    for (const Signal& signal : group.signals) {
      const std::vector<double>& x = signal.values;
      for (std::size_t i = 1; i < x.size(); ++i) {
        const double d = x[i] - x[i - 1];
        if (std::isfinite(d)) add(std::abs(d));
      }
    }
  });
  const auto ends = QuantilesOf({0.02, 0.98}, [&](auto add) {
    for (const Signal& signal : group.signals) {
      for (const double v : signal.values) {
        if (std::isfinite(v)) add(v);
      }
    }
  });
  const double range = ends[1] - ends[0];
  if (!(fast > kStretchCoarse * range)) return {};  // also if there are no increments
  std::vector<Centred> trials;
  for (const Signal& signal : group.signals) trials.emplace_back(signal.values);
  const Autoregression model(trials);
  if (!model.valid()) return {};
  std::vector<std::vector<double>> steps;
  std::size_t count = 0;
  for (const Centred& x : trials) {
    steps.push_back(model.Steps(x));
    count += CountFinite(steps.back());
  }
  if (count < kStretchFewest) return {};
  const double usual =
      QuantileOf(1 - std::max(0.01, kStretchFaults / static_cast<double>(count)), [&](auto add) {
        for (const auto& of_trial : steps) AddSizes(of_trial, add);
      });
  std::vector<Finding> found;
  for (std::size_t s = 0; s < trials.size(); ++s) {
    const double of_trial = trials[s].Range();
    if (CountFinite(steps[s]) < kStretchFewest / 2 || !(of_trial > 0)) continue;
    const double large = QuantileOf(0.9, [&](auto add) { AddSizes(steps[s], add); });
    const double least = std::max(kStretchBeyond * std::max(usual, large), kStretchOfRange * of_trial);
    Finding finding = group.signals[s].Found(FindingKind::kDisplaced);
    finding.usual = usual;
    for (const auto& [first, after] : Pairs(trials[s], steps[s], least)) {
      finding.spans.push_back(group.signals[s].Span(first, after - 1));
      finding.size = std::max(finding.size, std::abs(steps[s][first]));
    }
    std::sort(finding.spans.begin(), finding.spans.end(),
              [](const TimeSpan& a, const TimeSpan& b) { return a.from < b.from; });
    if (!finding.spans.empty()) found.push_back(std::move(finding));
  }
  return found;
}

}  // namespace sinew
