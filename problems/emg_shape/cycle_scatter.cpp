#include "problems/emg_shape/cycle_scatter.h"

#include <algorithm>
#include <cmath>

#include "models/emg/periodic_spline.h"

namespace sinew {
namespace {

// Least scatter: of a movement that repeats itself exactly nothing would be left to learn a prior from.
constexpr double kLeastGain = 0.01;
constexpr double kLeastTiming = 0.001;
constexpr double kFewest = 4;      // samples of a burst
constexpr double kWellTold = 0.2;  // share of the mean burst's information below which one says nothing

// Sums over samples of one burst.
struct BurstSums {
  double pp = 0;  // shape
  double ps = 0;  // shape and slope
  double ss = 0;
  double pr = 0;  // residual
  double sr = 0;
  double rr = 0;
  double count = 0;
};

}  // namespace

Result<CycleScatter> EstimateCycleScatter(const std::vector<CycleSamples>& recordings, int knots,
                                          double correlated) {
  if (recordings.empty()) return Fail("no recording");
  std::vector<BurstSums> bursts;
  double degrees = 0;
  for (const CycleSamples& recording : recordings) {
    SINEW_ASSIGN(const Vector shape, FitPeriodicSpline(recording.phase, recording.values, knots));
    degrees -= knots;
    const double floor = shape.minCoeff();
    for (std::size_t i = 0; i < recording.phase.size(); ++i) {
      if (i == 0 || recording.burst[i] != recording.burst[i - 1]) bursts.emplace_back();
      BurstSums& sums = bursts.back();
      const PeriodicBasis basis = PeriodicBasisAt(recording.phase[i], knots);
      const double p = basis.At(shape.data());
      const double slope = basis.SlopeAt(shape.data());
      const double r = recording.values[i] - p;
      const double above = p - floor;  // a gain leaves the floor as it is
      sums.pp += above * above;
      sums.ps += above * slope;
      sums.ss += slope * slope;
      sums.pr += above * r;
      sums.sr += slope * r;
      sums.rr += r * r;
      sums.count += 1;
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
  }
  CycleScatter scatter;
  const double variance = std::max(left, 0.0) / std::max(degrees, 1.0);
  scatter.noise = std::sqrt(variance);
  if (told < 2) {
    scatter.gain = kLeastGain;
    scatter.timing = kLeastTiming;
    return scatter;
  }
  // The mean of each recording's bursts was taken away with its shape.
  double shapes = 0;
  for (const CycleSamples& recording : recordings) shapes += recording.bursts;
  const double freedom = std::max(told - shapes, 1.0);
  const auto deviation = [&](double squares, double noise, double least) {
    return std::sqrt(std::max(squares / freedom - correlated * variance * noise / told, least * least));
  };
  scatter.gain = deviation(gain_squares, gain_noise, kLeastGain);
  scatter.timing = deviation(timing_squares, timing_noise, kLeastTiming);
  return scatter;
}

}  // namespace sinew
