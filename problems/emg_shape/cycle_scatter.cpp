#include "problems/emg_shape/cycle_scatter.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "models/emg/shape_basis.h"

namespace sinew {
namespace {

constexpr double kFewest = 4;        // samples of a burst
constexpr double kMostTaken = 0.8;   // share of a sample's noise that a regression is believed to have taken
constexpr double kMostGrowth = 0.5;  // share of the variance that may come from the EMG
constexpr double kWellTold = 0.2;    // share of the mean burst's information below which one says nothing

// Sums over samples of one burst.
struct BurstSums {
  double pp = 0;  // shape
  double ps = 0;  // shape and slope
  double ss = 0;
  double pr = 0;  // residual
  double sr = 0;
  double rr = 0;
  double count = 0;
  double middle = 0;  // sum of squares times place
  int recording = 0;
};

struct Sample {
  int burst = 0;
  double emg = 0;  // of the shape
  double above = 0;
  double slope = 0;
  double residual = 0;
};

// Noise whose variance grows with the square of the EMG, by least squares on the squares of what gains and
// timings, drawn to 0 by their scatter, leave over. What they took from a sample is given back: most where a
// burst is, whose few independent samples they nearly explain. Neither part is negative.
void FindNoise(const std::vector<Sample>& samples, const std::vector<BurstSums>& bursts, double variance,
               double correlated, CycleScatter& scatter) {
  const double one = correlated * variance;    // of an independent value
  std::vector<std::array<double, 3>> inverse;  // of each burst's information: gain, both, timing
  std::vector<std::array<double, 2>> found;
  for (const BurstSums& of : bursts) {
    const double gain = of.pp / one + 1 / (scatter.gain * scatter.gain);
    const double timing = of.ss / one + 1 / (scatter.timing * scatter.timing);
    const double both = of.ps / one;
    const double determinant = gain * timing - both * both;
    inverse.push_back({timing / determinant, -both / determinant, gain / determinant});
    found.push_back({(timing * of.pr - both * of.sr) / one / determinant,
                     (gain * of.sr - both * of.pr) / one / determinant});
  }
  double count = 0;
  double e = 0;
  double ee = 0;
  double r = 0;
  double er = 0;
  for (const Sample& sample : samples) {
    const auto of = static_cast<std::size_t>(sample.burst);
    const double left = sample.residual - found[of][0] * sample.above - found[of][1] * sample.slope;
    const double taken =
        (inverse[of][0] * sample.above * sample.above + 2 * inverse[of][1] * sample.above * sample.slope +
         inverse[of][2] * sample.slope * sample.slope) /
        variance;
    const double squared = left * left / (1 - std::min(taken, kMostTaken));
    const double square = sample.emg * sample.emg;
    count += 1;
    e += square;
    ee += square * square;
    r += squared;
    er += square * squared;
  }
  const double spread = count * ee - e * e;
  double growth = spread > 0 ? (count * er - e * r) / spread : 0;
  growth = std::clamp(growth, 0.0, e > 0 ? kMostGrowth * r / e : 0.0);
  scatter.growth = std::sqrt(growth);
  scatter.quiet = std::sqrt((r - growth * e) / count);
  scatter.noise = std::sqrt(r / count);
}

}  // namespace

Result<CycleScatter> EstimateCycleScatter(const std::vector<CycleSamples>& recordings, int knots,
                                          double correlated) {
  if (recordings.empty()) return Fail("no recording");
  const ShapeBasis basis(knots);
  std::vector<BurstSums> bursts;
  std::vector<Sample> samples;
  double degrees = 0;
  for (const CycleSamples& recording : recordings) {
    SINEW_ASSIGN(const Vector shape, FitShape(recording.phase, recording.values, basis));
    degrees -= knots;
    const double floor = shape.minCoeff();
    for (std::size_t i = 0; i < recording.phase.size(); ++i) {
      if (i == 0 || recording.burst[i] != recording.burst[i - 1]) bursts.emplace_back();
      BurstSums& sums = bursts.back();
      const double p = basis.Value(recording.phase[i], shape.data());
      const double slope = basis.Slope(recording.phase[i], shape.data());
      const double r = recording.values[i] - p;
      const double above = p - floor;  // a gain leaves the floor as it is
      sums.pp += above * above;
      sums.ps += above * slope;
      sums.ss += slope * slope;
      sums.pr += above * r;
      sums.sr += slope * r;
      sums.rr += r * r;
      sums.count += 1;
      sums.middle += above * above * (recording.cycle[i] + recording.phase[i]);
      sums.recording = static_cast<int>(&recording - recordings.data());
      samples.push_back({static_cast<int>(bursts.size()) - 1, p, above, slope, r});
    }
  }
  double mean_pp = 0;
  double mean_ss = 0;
  for (const BurstSums& sums : bursts) {
    mean_pp += sums.pp / static_cast<double>(bursts.size());
    mean_ss += sums.ss / static_cast<double>(bursts.size());
  }
  double left = 0;
  double gain_squares = 0;
  double timing_squares = 0;
  double gain_noise = 0;  // variances of the estimates, of unit noise
  double timing_noise = 0;
  double told = 0;
  CycleScatter scatter;
  for (const BurstSums& sums : bursts) {
    left += sums.rr;
    degrees += sums.count;
    const double determinant = sums.pp * sums.ss - sums.ps * sums.ps;
    const bool tells = sums.count >= kFewest && sums.pp > kWellTold * mean_pp &&
                       sums.ss > kWellTold * mean_ss && determinant > 1e-6 * sums.pp * sums.ss;
    if (!tells) continue;
    const double gain = (sums.ss * sums.pr - sums.ps * sums.sr) / determinant;
    const double timing = (sums.pp * sums.sr - sums.ps * sums.pr) / determinant;
    left -= gain * sums.pr + timing * sums.sr;
    degrees -= 2;
    gain_squares += gain * gain;
    timing_squares += timing * timing;
    gain_noise += sums.ss / determinant;
    timing_noise += sums.pp / determinant;
    told += 1;
    scatter.timings.push_back({sums.recording, static_cast<int>(std::floor(sums.middle / sums.pp)), timing});
  }
  const double variance = std::max(left, 0.0) / std::max(degrees, 1.0);
  scatter.gain = kLeastGainScatter;
  scatter.timing = kLeastTimingScatter;
  // The mean of each recording's bursts was taken away with its shape.
  double shapes = 0;
  for (const CycleSamples& recording : recordings) shapes += recording.bursts;
  const double freedom = std::max(told - shapes, 1.0);
  const auto deviation = [&](double squares, double noise, double least) {
    return std::sqrt(std::max(squares / freedom - correlated * variance * noise / told, least * least));
  };
  if (told >= 2) {
    scatter.gain = deviation(gain_squares, gain_noise, kLeastGainScatter);
    scatter.timing = deviation(timing_squares, timing_noise, kLeastTimingScatter);
  }
  if (variance > 0) FindNoise(samples, bursts, variance, correlated, scatter);
  return scatter;
}

double SharedTiming(const std::vector<std::vector<BurstTiming>>& muscles) {
  std::map<std::pair<int, int>, std::vector<double>> cycles;  // (recording, cycle) -> mean of each muscle
  for (const auto& timings : muscles) {
    std::map<std::pair<int, int>, std::pair<double, int>> sums;
    for (const BurstTiming& burst : timings) {
      auto& [sum, count] = sums[{burst.recording, burst.cycle}];
      sum += burst.timing;
      ++count;
    }
    for (const auto& [key, sum] : sums) cycles[key].push_back(sum.first / sum.second);
  }
  double products = 0;
  double pairs = 0;
  for (const auto& [key, means] : cycles) {
    for (std::size_t a = 0; a < means.size(); ++a) {
      for (std::size_t b = 0; b < a; ++b) {
        products += means[a] * means[b];
        pairs += 1;
      }
    }
  }
  return pairs > 0 ? std::sqrt(std::max(products / pairs, 0.0)) : 0;
}

}  // namespace sinew
