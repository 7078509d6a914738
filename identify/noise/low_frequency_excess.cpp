#include "identify/noise/low_frequency_excess.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include "base/constants.h"

namespace sinew::noise {
namespace {

constexpr int kLongest = 1024;                  // samples of one transform, whose cost is their square
constexpr double kLowerEnds[] = {0.125, 0.25};  // of the upper band, as shares of half the sampling rate
constexpr double kLeastCorrelation = -0.5;
constexpr double kStep = 0.01;        // of the correlation of neighbours
constexpr double kInRegion = 5.4138;  // half of the 99.9 % quantile of chi-squared with one degree of freedom
constexpr int kParts = 4;             // of the band, in each of which the spectrum must fit ...
constexpr double kNormal = 3.29;      // ... within its scatter, two-sided 0.1 %

// A frequency of the transform.
struct Line {
  double cosine;  // of the angle per sample
  double share;   // of half the sampling rate
  double power;   // squared coefficient of the orthonormal transform
};

// Of the differences of neighbours, and divided by their gain: the slopes at both ends of what is smooth
// would show at high frequencies, too.
void AppendTransform(const Eigen::Ref<const Vector>& samples, std::vector<Line>& lines) {
  const Vector x = samples.tail(samples.size() - 1) - samples.head(samples.size() - 1);
  const int n = static_cast<int>(x.size());
  std::vector<double> table(static_cast<std::size_t>(4 * n));
  for (int i = 0; i < 4 * n; ++i) table[static_cast<std::size_t>(i)] = std::cos(kPi * i / (2 * n));
  for (int k = static_cast<int>(std::ceil(kLowerEnds[0] * n)); k < n; ++k) {
    double sum = 0;
    int at = k;  // (2 i + 1) k, modulo the period
    for (int i = 0; i < n; ++i) {
      sum += x[i] * table[static_cast<std::size_t>(at)];
      at += 2 * k;
      if (at >= 4 * n) at -= 4 * n;
    }
    const double cosine = std::cos(kPi * k / n);
    lines.push_back({cosine, static_cast<double>(k) / n, sum * sum * 2 / n / (2 - 2 * cosine)});
  }
}

// Largest deviation of AR(1) noise with the spectrum of these lines from a lower end on; nothing if they are
// no such spectrum.
std::optional<double> LargestDeviation(const std::vector<Line>& lines, double lower_end) {
  std::vector<Line> band;
  std::copy_if(lines.begin(), lines.end(), std::back_inserter(band),
               [&](const Line& line) { return line.share >= lower_end; });
  struct Fit {
    double correlation;
    double innovation;  // variance
    double likelihood;  // logarithm
  };
  std::vector<Fit> fits;
  const auto count = static_cast<double>(band.size());
  for (double rho = kLeastCorrelation; rho < 0.999; rho += kStep) {
    double innovation = 0;
    double logarithms = 0;
    for (const Line& line : band) {
      const double inverse = 1 + rho * rho - 2 * rho * line.cosine;  // of the spectrum
      innovation += line.power * inverse / count;
      logarithms -= std::log(inverse);
    }
    if (!(innovation > 0)) return {};
    fits.push_back({rho, innovation, -0.5 * (count * std::log(innovation) + logarithms)});
  }
  const Fit& best = *std::max_element(fits.begin(), fits.end(),
                                      [](const Fit& a, const Fit& b) { return a.likelihood < b.likelihood; });
  std::array<double, kParts> means{};
  std::array<int, kParts> counts{};
  for (const Line& line : band) {
    const double inverse = 1 + best.correlation * (best.correlation - 2 * line.cosine);
    const double along = (line.share - lower_end) / (1 - lower_end);
    const auto part = static_cast<std::size_t>(std::min(static_cast<int>(along * kParts), kParts - 1));
    means[part] += line.power * inverse / best.innovation;
    ++counts[part];
  }
  for (std::size_t part = 0; part < kParts; ++part) {
    if (counts[part] == 0) return {};
    const double scatter = kNormal * std::sqrt(2.0 / counts[part]);  // of a mean of squared normal values
    if (std::abs(means[part] / counts[part] - 1) > scatter) return {};
  }
  double variance = 0;
  for (const Fit& fit : fits) {
    if (fit.likelihood < best.likelihood - kInRegion) continue;
    variance = std::max(variance, fit.innovation / (1 - fit.correlation * fit.correlation));
  }
  return std::sqrt(variance);
}

}  // namespace

std::optional<LowFrequencyExcess> FindLowFrequencyExcess(const std::vector<Vector>& stretches) {
  std::vector<Line> lines;
  double squares = 0;
  double samples = 0;
  for (const Vector& stretch : stretches) {
    const auto n = static_cast<int>(stretch.size());
    if (n < kSamplesForSpectrum) continue;
    squares += stretch.squaredNorm();
    samples += n;
    const int pieces = (n + kLongest - 1) / kLongest;
    for (int piece = 0; piece < pieces; ++piece) {
      const int begin = static_cast<int>(static_cast<long>(n) * piece / pieces);
      const int end = static_cast<int>(static_cast<long>(n) * (piece + 1) / pieces);
      AppendTransform(stretch.segment(begin, end - begin), lines);
    }
  }
  if (lines.empty()) return {};
  std::optional<double> noise;
  for (const double lower_end : kLowerEnds) {
    const auto largest = LargestDeviation(lines, lower_end);
    if (largest && (!noise || *largest < *noise)) noise = largest;
  }
  if (!noise) return {};
  return LowFrequencyExcess{std::sqrt(squares / samples), *noise};
}

}  // namespace sinew::noise
