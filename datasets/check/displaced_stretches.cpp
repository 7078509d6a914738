#include "datasets/check/displaced_stretches.h"

#include <algorithm>
#include <cmath>

#include "base/decompositions.h"
#include "base/linear_algebra.h"
#include "datasets/robust.h"

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

// x[t] less its median is predicted by the kStretchOrder values before it.
class Autoregression {
 public:
  // Least squares over all trials, repeated without what is predicted worst.
  explicit Autoregression(const std::vector<std::vector<double>>& trials) {
    double limit = INFINITY;
    for (int pass = 0; pass < kStretchPasses; ++pass) {
      Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(kStretchOrder, kStretchOrder);
      Eigen::VectorXd right = Eigen::VectorXd::Zero(kStretchOrder);
      std::vector<double> sizes;
      Eigen::VectorXd past(kStretchOrder);
      for (const auto& x : trials) {
        for (std::size_t t = kStretchOrder; t < x.size(); ++t) {
          const double e = pass == 0 ? 0 : Innovation(x, t);
          for (int k = 0; k < kStretchOrder; ++k) past[k] = x[t - 1 - static_cast<std::size_t>(k)];
          if (!std::isfinite(past.sum() + x[t])) continue;
          sizes.push_back(std::abs(e));
          if (std::abs(e) > limit) continue;
          gram += past * past.transpose();
          right += x[t] * past;
        }
      }
      if (!(gram.trace() > 0)) return;
      gram.diagonal().array() += kStretchRidge * gram.trace() / kStretchOrder;
      weights_ = gram.ldlt().solve(right);
      sizes.clear();
      for (const auto& x : trials) {
        for (std::size_t t = kStretchOrder; t < x.size(); ++t) {
          const double e = Innovation(x, t);
          if (std::isfinite(e)) sizes.push_back(std::abs(e));
        }
      }
      if (sizes.empty()) return;
      limit = kStretchOutlier * 1.4826 * Median(std::move(sizes));
    }
    // What a unit step leaves: its innovations.
    step_ = {1};
    for (int k = 0; k < kStretchOrder; ++k) step_.push_back(step_.back() - weights_[k]);
  }

  [[nodiscard]] bool valid() const { return !step_.empty(); }

  // The step at each sample that fits the innovations from there on best, [N]; NaN where there are too few.
  [[nodiscard]] std::vector<double> Steps(const std::vector<double>& x) const {
    std::vector<double> innovations(x.size(), NAN);
    for (std::size_t t = kStretchOrder; t < x.size(); ++t) innovations[t] = Innovation(x, t);
    std::vector<double> steps(x.size(), NAN);
    for (std::size_t t = 0; t < x.size(); ++t) {
      double products = 0;
      double squares = 0;
      for (std::size_t k = 0; k < step_.size() && t + k < x.size(); ++k) {
        products += step_[k] * innovations[t + k];  // NaN next to a gap
        squares += step_[k] * step_[k];
      }
      steps[t] = products / squares;
    }
    return steps;
  }

 private:
  [[nodiscard]] double Innovation(const std::vector<double>& x, std::size_t t) const {
    double e = x[t];
    for (int k = 0; k < kStretchOrder; ++k) e -= weights_[k] * x[t - 1 - static_cast<std::size_t>(k)];
    return e;
  }

  Eigen::VectorXd weights_;
  std::vector<double> step_;
};

std::vector<double> Sizes(const std::vector<double>& values) {
  std::vector<double> sizes = Finite(values);
  for (double& v : sizes) v = std::abs(v);
  return sizes;
}

double Range(const std::vector<double>& values) {
  const auto finite = Finite(values);
  return finite.size() < 10 ? 0 : Quantile(finite, 0.98) - Quantile(finite, 0.02);
}

// Whether the signal is, on the whole, away from what is around by half of the step at least. Stretches that
// are shorter than an oscillation may be anywhere.
bool IsAway(const std::vector<double>& x, std::size_t first, std::size_t after, double step) {
  const std::size_t length = after - first;
  if (length < 2 * kStretchOrder) return true;
  std::vector<double> around;
  std::vector<double> inside;
  for (std::size_t i = first > length ? first - length : 0; i < std::min(after + length, x.size()); ++i) {
    if (std::isfinite(x[i])) (i >= first && i < after ? inside : around).push_back(x[i]);
  }
  if (inside.empty() || around.empty()) return false;
  return (Median(inside) - Median(around)) / step > 0.5;
}

// Pairs of opposite steps of like size, the largest first; they do not overlap.
std::vector<std::pair<std::size_t, std::size_t>> Pairs(const std::vector<double>& x,
                                                       const std::vector<double>& steps, double least) {
  std::vector<std::size_t> at;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    bool largest = std::abs(steps[i]) >= least;
    const std::size_t from = i > kStretchAround ? i - kStretchAround : 0;
    for (std::size_t j = from; largest && j <= i + kStretchAround && j < steps.size(); ++j)
      largest = !(std::abs(steps[j]) > std::abs(steps[i]));
    if (largest) at.push_back(i);
  }
  const auto longest = static_cast<std::size_t>(kStretchLongest * static_cast<double>(steps.size()));
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  while (true) {
    std::pair<std::size_t, std::size_t> best{0, 0};
    double most = 0;
    for (const std::size_t a : at) {
      for (const std::size_t b : at) {
        if (b < a + kStretchLeast || b > a + longest || !(steps[a] * steps[b] < 0)) continue;
        const double smaller = std::min(std::abs(steps[a]), std::abs(steps[b]));
        const double larger = std::max(std::abs(steps[a]), std::abs(steps[b]));
        const bool overlaps = std::any_of(pairs.begin(), pairs.end(),
                                          [&](const auto& p) { return a <= p.second && b >= p.first; });
        if (overlaps || smaller < kStretchAlike * larger || smaller <= most || !IsAway(x, a, b, steps[a]))
          continue;
        most = smaller;
        best = {a, b};
      }
    }
    if (most == 0) return pairs;
    pairs.push_back(best);
  }
}

}  // namespace

std::vector<Finding> FindDisplacedStretches(const ChannelGroup& group) {
  std::vector<std::vector<double>> trials;
  std::vector<double> all;
  std::vector<double> increments;
  for (const Signal& signal : group.signals) {
    for (const double v : Finite(signal.values)) all.push_back(v);
    for (const double d : Sizes(Increments(signal.values))) increments.push_back(d);
  }
  if (all.size() < kStretchFewest || increments.empty()) return {};
  const double range = Range(all);
  if (!(Quantile(increments, 0.99) > kStretchCoarse * range)) return {};
  for (const Signal& signal : group.signals) {
    trials.push_back(signal.values);
    const auto finite = Finite(signal.values);
    if (finite.empty()) continue;
    const double middle = Median(finite);
    for (double& v : trials.back()) v -= middle;
  }
  const Autoregression model(trials);
  if (!model.valid()) return {};
  std::vector<std::vector<double>> steps;
  std::vector<double> sizes;
  for (const auto& x : trials) {
    steps.push_back(model.Steps(x));
    for (const double d : Sizes(steps.back())) sizes.push_back(d);
  }
  if (sizes.size() < kStretchFewest) return {};
  const double usual =
      Quantile(sizes, 1 - std::max(0.01, kStretchFaults / static_cast<double>(sizes.size())));
  std::vector<Finding> found;
  for (std::size_t s = 0; s < trials.size(); ++s) {
    const auto here = Sizes(steps[s]);
    const double of_trial = Range(trials[s]);
    if (here.size() < kStretchFewest / 2 || !(of_trial > 0)) continue;
    const double least =
        std::max(kStretchBeyond * std::max(usual, Quantile(here, 0.9)), kStretchOfRange * of_trial);
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
