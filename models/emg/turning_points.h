// Turning points of a recorded angle with noise, timed between its samples.
#pragma once

#include <cstddef>
#include <vector>

namespace sinew {

/// One of the highest or lowest angles between which a joint moves to and fro.
struct TurningPoint {
  bool highest = false;
  std::size_t sample = 0;  ///< the extreme sample; the first of equal ones
  double angle = 0;        ///< corrected for the bias of an extreme sample by noise [unit of the angle]
  double time_s = 0;       ///< [s]
  double from_s = 0;       ///< time_s was found from the samples from here [s]
  double to_s = 0;         ///< to here [s]
};

/// Standard deviation of the white noise on a signal: median |fourth difference| / (0.6745 sqrt 70). A motion
/// of up to 1/30 of the sampling rate adds less than 0.1 % of its amplitude.
/// @param angle [N, finite] @return [unit of the angle]; 0 for fewer than 5 samples. O(N).
[[nodiscard]] double NoiseOfAngle(const std::vector<double>& angle);

/// Extreme samples, highest and lowest in turn, each at least `swing` from its neighbours: what happens
/// between them is smaller (hysteresis). The first and the last one are cut off by the recording's ends: the
/// angle may have been, or become, more extreme. O(N).
/// @param angle [N, finite] @param swing [unit of the angle, > 0] @return indices, alternating; none, or 2 or
/// more
[[nodiscard]] std::vector<std::size_t> FindExtremeSamples(const std::vector<double>& angle, double swing);

/// The same with their times and angles, without the first and the last one.
///
/// Time: with P the extreme angle and c(d) the centroid in time of the area between the curve and the level P
/// - d, t = 2 c(d) - c(2 d). Exact for a peak between straight flanks of different slopes and, to first order
/// in its skewness, for a smooth one; of a plateau, its middle. The areas average the noise. d is 5 % of the
/// swing, 6 times the noise or what spans 8 samples, whichever is most, but at most 20 %.
///
/// @param time [N, s, strictly increasing] @param angle [N, finite] @param swing [unit of the angle, > 0]
/// @param noise standard deviation of noise [unit of the angle, >= 0]. O(N).
[[nodiscard]] std::vector<TurningPoint> FindTurningPoints(const std::vector<double>& time,
                                                          const std::vector<double>& angle, double swing,
                                                          double noise);

}  // namespace sinew
