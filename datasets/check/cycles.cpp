#include "datasets/check/cycles.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "datasets/order_statistics.h"
#include "datasets/robust.h"

namespace sinew {
namespace {

constexpr std::size_t kCycleFewest = 6;
constexpr double kCycleRate_Hz = 100;  // at most: of the series that cycles are looked for in
constexpr std::size_t kCycleMostSamples = 8000;
constexpr std::size_t kCycleMostChannels = 30;
constexpr double kCycleMinPeriodic = 0.6;  // autocorrelation at the period
constexpr double kCycleAlmostBest = 0.93;  // of the largest autocorrelation: the shortest such period
constexpr double kCycleMinAlike = 0.5;     // correlation of a cycle with the median cycle
constexpr double kCycleLimit = 4;          // robust deviations, beyond which values are limited

struct Series {
  double start = 0;  // [s]
  double step = 0;   // [s]
  std::vector<std::vector<double>> values;
};

double Limited(double value, double middle, double deviation) {
  return std::isfinite(value) ? std::clamp(value - middle, -kCycleLimit * deviation, kCycleLimit * deviation)
                              : 0;
}

// Channels that vary, on one clock, less their medians, limited to a few robust deviations, gaps at 0.
Series Sampled(const std::vector<const Signal*>& signals) {
  Series series;
  double end = std::numeric_limits<double>::infinity();
  series.start = -end;
  double finest = end;
  for (const Signal* signal : signals) {
    const TimeSpan whole = signal->Whole();
    if (signal->size() < 50) continue;
    series.start = std::max(series.start, whole.from);
    end = std::min(end, whole.to);
    finest = std::min(finest, (whole.to - whole.from) / static_cast<double>(signal->size() - 1));
  }
  if (!(end > series.start)) return series;
  series.step = std::max({finest, 1 / kCycleRate_Hz, (end - series.start) / kCycleMostSamples});
  const auto samples = static_cast<std::size_t>((end - series.start) / series.step) + 1;
  const std::size_t stride = std::max<std::size_t>(1, signals.size() / kCycleMostChannels);
  for (std::size_t s = 0; s < signals.size(); s += stride) {
    const Signal& signal = *signals[s];
    if (2 * CountFinite(signal.values) < signal.size() || signal.size() < 50) continue;
    const auto levels = FiniteQuantiles(signal.values, {0.05, 0.5, 0.95});
    const double middle = levels[1];
    const double robust = RobustDeviationOf([&](auto add) {
      for (const double v : signal.values) {
        if (std::isfinite(v)) add(v);
      }
    });
    // Signals that rest most of the time have a robust deviation of 0.
    const double deviation = std::max(robust, (levels[2] - levels[0]) / 4);
    if (!(deviation > 0)) continue;
    std::vector<double> values(samples);
    for (std::size_t i = 0; i < samples; ++i) {
      const double t = series.start + static_cast<double>(i) * series.step;
      values[i] = Limited(ValueAt(*signal.time, signal.values, t), middle, deviation) / deviation;
    }
    series.values.push_back(std::move(values));
  }
  return series;
}

// Correlation of the series with itself, `lag` samples later.
double AutocorrelationAt(const std::vector<double>& x, std::size_t lag) {
  double ab = 0;
  double aa = 0;
  double bb = 0;
  for (std::size_t i = 0; i + lag < x.size(); ++i) {
    ab += x[i] * x[i + lag];
    aa += x[i] * x[i];
    bb += x[i + lag] * x[i + lag];
  }
  return aa > 0 && bb > 0 ? ab / std::sqrt(aa * bb) : 0;
}

struct Period {
  std::size_t samples = 0;
  std::size_t reference = 0;  // channel
};

// The shortest lag at which the autocorrelation of the most periodic channels has a peak almost as high as
// its highest.
Period FindPeriod(const Series& series) {
  const std::size_t n = series.values.front().size();
  const std::size_t longest = n / kCycleFewest;
  if (longest < 8) return {};
  std::vector<std::vector<double>> all;
  std::vector<double> mean(longest + 1, 0);
  for (const auto& x : series.values) {
    std::vector<double> r(longest + 1, 0);
    double average = 0;
    for (const double v : x) average += v / static_cast<double>(n);
    std::vector<double> centred = x;
    for (double& v : centred) v -= average;
    for (std::size_t lag = 1; lag <= longest; ++lag) r[lag] = AutocorrelationAt(centred, lag);
    all.push_back(std::move(r));
  }
  // Many channels may be mostly noise: the third that is most periodic decides.
  const std::size_t counted = std::max<std::size_t>(1, all.size() / 3);
  for (std::size_t lag = 1; lag <= longest; ++lag) {
    std::vector<double> at;
    for (const auto& r : all) at.push_back(r[lag]);
    std::partial_sort(at.begin(), at.begin() + static_cast<std::ptrdiff_t>(counted), at.end(),
                      std::greater<>());
    for (std::size_t c = 0; c < counted; ++c) mean[lag] += at[c] / static_cast<double>(counted);
  }
  std::size_t from = 1;
  while (from < longest && mean[from] > mean[from + 1]) ++from;  // down to the first minimum
  double best = 0;
  for (std::size_t lag = from + 1; lag < longest; ++lag) {
    if (mean[lag] >= mean[lag - 1] && mean[lag] >= mean[lag + 1]) best = std::max(best, mean[lag]);
  }
  if (best < kCycleMinPeriodic) return {};
  for (std::size_t lag = from + 1; lag < longest; ++lag) {
    if (!(mean[lag] >= mean[lag - 1] && mean[lag] >= mean[lag + 1] && mean[lag] > kCycleAlmostBest * best))
      continue;
    Period period{lag, 0};
    for (std::size_t c = 1; c < all.size(); ++c) {
      if (all[c][lag] > all[period.reference][lag]) period.reference = c;
    }
    return period;
  }
  return {};
}

double TemplateCorrelation(const std::vector<double>& x, std::size_t at, const std::vector<double>& wanted) {
  double mean = 0;
  for (std::size_t i = 0; i < wanted.size(); ++i) mean += x[at + i];
  mean /= static_cast<double>(wanted.size());
  double ab = 0;
  double bb = 0;
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    ab += (x[at + i] - mean) * wanted[i];
    bb += (x[at + i] - mean) * (x[at + i] - mean);
  }
  return bb > 0 ? ab / std::sqrt(bb) : 0;
}

// Mean 0, norm 1.
void Normalise(std::vector<double>& wanted) {
  double mean = 0;
  for (const double v : wanted) mean += v / static_cast<double>(wanted.size());
  double norm = 0;
  for (double& v : wanted) {
    v -= mean;
    norm += v * v;
  }
  if (norm > 0) {
    for (double& v : wanted) v /= std::sqrt(norm);
  }
}

struct Match {
  std::vector<std::size_t> starts;
  double typical = 0;  // median correlation
};

Match FindMatches(const std::vector<double>& x, const std::vector<double>& wanted) {
  const std::size_t period = wanted.size();
  std::vector<double> correlation(x.size() - period);
  for (std::size_t i = 0; i < correlation.size(); ++i) correlation[i] = TemplateCorrelation(x, i, wanted);
  const std::size_t apart = 2 * period / 3;
  Match match;
  std::vector<double> reached;
  for (std::size_t i = 0; i < correlation.size(); ++i) {
    if (correlation[i] < kCycleMinAlike) continue;
    const std::size_t from = i > apart ? i - apart : 0;
    const std::size_t to = std::min(i + apart, correlation.size() - 1);
    const auto begin = correlation.begin();
    const auto largest = std::max_element(begin + static_cast<std::ptrdiff_t>(from),
                                          begin + static_cast<std::ptrdiff_t>(to) + 1);
    if (largest - begin != static_cast<std::ptrdiff_t>(i)) continue;
    match.starts.push_back(i);
    reached.push_back(correlation[i]);
  }
  if (!reached.empty()) match.typical = Median(reached);
  return match;
}

std::vector<double> MedianCycle(const std::vector<double>& x, const std::vector<std::size_t>& starts,
                                std::size_t period) {
  std::vector<double> median(period);
  for (std::size_t i = 0; i < period; ++i) {
    std::vector<double> at;
    for (const std::size_t start : starts) {
      if (start + i < x.size()) at.push_back(x[start + i]);
    }
    median[i] = Median(std::move(at));
  }
  return median;
}

}  // namespace

double ValueAt(const std::vector<double>& time, const std::vector<double>& values, double t) {
  const auto next = std::upper_bound(time.begin(), time.end(), t);
  if (next == time.begin()) return std::numeric_limits<double>::quiet_NaN();
  const auto i = static_cast<std::size_t>(next - time.begin()) - 1;
  if (time[i] == t) return values[i];
  if (next == time.end()) return std::numeric_limits<double>::quiet_NaN();
  const double share = (t - time[i]) / (time[i + 1] - time[i]);
  return values[i] + share * (values[i + 1] - values[i]);
}

Cycles FindCycles(const std::vector<const Signal*>& signals) {
  if (signals.empty()) return {};
  const Series series = Sampled(signals);
  if (series.values.empty() || series.values.front().size() < 60) return {};
  const Period period = FindPeriod(series);
  if (period.samples < 8) return {};
  const std::vector<double>& x = series.values[period.reference];
  Match best;
  constexpr std::size_t kTried = 8;
  for (std::size_t i = 0; i < kTried; ++i) {
    const std::size_t at = (x.size() - period.samples) * i / kTried;
    std::vector<double> wanted(x.begin() + static_cast<std::ptrdiff_t>(at),
                               x.begin() + static_cast<std::ptrdiff_t>(at + period.samples));
    Normalise(wanted);
    Match match = FindMatches(x, wanted);
    if (match.typical > best.typical) best = std::move(match);
  }
  if (best.starts.size() < kCycleFewest) return {};
  std::vector<double> median = MedianCycle(x, best.starts, period.samples);
  Normalise(median);
  best = FindMatches(x, median);
  if (best.starts.size() < kCycleFewest) return {};
  Cycles cycles;
  std::vector<double> lengths;
  for (std::size_t k = 0; k + 1 < best.starts.size(); ++k)
    lengths.push_back(static_cast<double>(best.starts[k + 1] - best.starts[k]));
  cycles.period = Median(lengths) * series.step;
  const auto time = [&](std::size_t i) { return series.start + static_cast<double>(i) * series.step; };
  for (std::size_t k = 0; k < best.starts.size(); ++k) {
    if (k > 0) {
      const double from = time(best.starts[k - 1]);
      const double length = time(best.starts[k]) - from;
      const int parts = std::max(1, static_cast<int>(std::lround(length / cycles.period)));
      for (int part = 1; part < parts; ++part) cycles.starts.push_back(from + length * part / parts);
    }
    cycles.starts.push_back(time(best.starts[k]));
  }
  if (cycles.count() < static_cast<int>(kCycleFewest) - 1) return {};
  return cycles;
}

}  // namespace sinew
