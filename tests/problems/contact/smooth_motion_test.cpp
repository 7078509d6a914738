#include "problems/contact/motion/smooth_motion.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/constants.h"
#include "base/random.h"

namespace sinew {
namespace {

constexpr double kLowest = 20;  // [Hz]

struct Recording {
  std::vector<double> time;
  std::vector<double> speed;  // true, along x [m/s]
  FootMotion foot;
};

// A foot that slides at 0.1 m/s, comes to rest within 0.15 s and turns a little.
Recording Slide(double rate, double noise) {
  constexpr double kSpeed = 0.1;
  constexpr double kStop = 0.15;  // [s]
  Recording recording;
  Random random(5);
  FootMotion::Body body;
  for (double t = 0; t < 0.6; t += 1 / rate) {
    const double s = std::min(t / kStop, 1.0);
    BodyMotion motion;
    motion.position.x() =
        kSpeed * kStop * (0.5 * s + std::sin(kPi * s) / (2 * kPi)) + noise * random.Normal();
    motion.velocity.x() = 0.5 * kSpeed * (1 + std::cos(kPi * s));
    motion.position.y() = noise * random.Normal();
    recording.time.push_back(t);
    recording.speed.push_back(motion.velocity.x());
    body.motion.push_back(motion);
    body.axis.emplace_back();
  }
  recording.foot.bodies = {body};
  recording.foot.PlaceCentre();
  return recording;
}

TEST(SmoothMotion, AMotionWithoutNoiseStaysAsItIs) {
  for (const double rate : {60.0, 100.0, 200.0}) {
    Recording recording = Slide(rate, 0);
    const std::vector<BodyMotion> before = recording.foot.bodies.front().motion;
    SmoothMotion(recording.time, kLowest, recording.foot);
    const std::vector<BodyMotion>& after = recording.foot.bodies.front().motion;
    for (std::size_t t = 0; t < before.size(); ++t) {
      EXPECT_EQ(after[t].position, before[t].position) << rate;
      EXPECT_EQ(after[t].velocity, before[t].velocity) << rate;
    }
  }
}

TEST(SmoothMotion, AFewFramesStayAsTheyAre) {
  Recording recording = Slide(100, 1e-3);
  for (const std::size_t frames : {1U, 2U, 4U}) {
    FootMotion few = recording.foot.Part(0, frames);
    const std::vector<double> time(recording.time.begin(),
                                   recording.time.begin() + static_cast<std::ptrdiff_t>(frames));
    SmoothMotion(time, kLowest, few);
    for (std::size_t t = 0; t < frames; ++t)
      EXPECT_EQ(few.bodies.front().motion[t].position, recording.foot.bodies.front().motion[t].position);
  }
}

TEST(SmoothMotion, NoiseOfTheSamplesIsTakenOut) {
  constexpr double kNoise = 1e-3;  // [m]
  constexpr double kRate = 100;    // [Hz]
  Recording recording = Slide(kRate, kNoise);
  SmoothMotion(recording.time, kLowest, recording.foot);
  double squares = 0;
  for (std::size_t t = 0; t < recording.time.size(); ++t)
    squares += std::pow(recording.foot.bodies.front().motion[t].velocity.x() - recording.speed[t], 2);
  const double error = std::sqrt(squares / static_cast<double>(recording.time.size()));
  // White noise below 20 Hz: its share of the power times the mean square of the angular frequency.
  const double expected = kNoise * std::sqrt(kLowest / (0.5 * kRate)) * 2 * kPi * kLowest / std::sqrt(3.0);
  EXPECT_LT(error, 2 * expected);
  EXPECT_GT(error, 0.3 * expected);
}

}  // namespace
}  // namespace sinew
