// Angles of movements to and fro whose turning points are known.
#pragma once

#include <cmath>
#include <functional>
#include <vector>

#include "base/constants.h"
#include "base/random.h"

namespace sinew {

struct Motion {
  double period_s = 0;
  double top_s = 0;                     ///< the highest angle, within the period
  std::function<double(double)> angle;  ///< of the time within the period [deg]
};

/// As a dynamometer imposes it: down and up again at constant speeds, at rest at both ends.
inline Motion ConstantSpeeds(double down, double up, double rest_s = 0, double range = 45) {
  Motion motion;
  motion.period_s = range / down + range / up + 2 * rest_s;
  motion.top_s = 0.5 * rest_s;  // the middle of the rest
  motion.angle = [=](double t) {
    t -= rest_s;
    if (t < 0) return range;
    if (t < range / down) return range - down * t;
    t -= range / down + rest_s;
    return t < 0 ? 0.0 : up * t;
  };
  return motion;
}

inline Motion Cosine(double period_s, double range = 45) {
  return {period_s, 0, [=](double t) { return 0.5 * range * std::cos(2 * kPi * t / period_s); }};
}

struct Recording {
  std::vector<double> time;
  std::vector<double> angle;
};

/// Begins at a share of the period.
inline Recording Record(const Motion& motion, double begins_at, double periods, double rate_Hz,
                        double noise = 0, std::uint64_t seed = 1) {
  Recording recording;
  Random random(seed);
  for (int k = 0; k < periods * motion.period_s * rate_Hz; ++k) {
    const double t = k / rate_Hz;
    recording.time.push_back(t);
    recording.angle.push_back(motion.angle(std::fmod(t + begins_at * motion.period_s, motion.period_s)) +
                              (noise > 0 ? noise * random.Normal() : 0));
  }
  return recording;
}

/// How far a time is from the nearest highest angle [s].
inline double OffTheTop(const Motion& motion, double begins_at, double time_s) {
  const double t = time_s + begins_at * motion.period_s - motion.top_s;
  return t - motion.period_s * std::round(t / motion.period_s);
}

}  // namespace sinew
