#include "problems/emg_shape/learning/modulated_noise.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/random.h"

namespace sinew {
namespace {

TEST(ModulatedNoise, IsFoundInBurstsAndInValleys) {
  Random random(1);
  for (const double quiet : {0.0003, 0.003}) {
    const ModulatedNoise truth{quiet, 0.08};
    std::vector<double> squares;
    std::vector<double> emg;
    for (int i = 0; i < 3000; ++i) {
      const double away = (i % 40 - 20) / 4.0;
      emg.push_back(0.005 + 0.5 * std::exp(-0.5 * away * away));
      squares.push_back(std::pow(truth.At(emg.back()) * random.Normal(), 2));
    }
    const ModulatedNoise found = FitModulatedNoise(squares, emg);
    EXPECT_NEAR(found.growth, 0.08, 0.006) << quiet;
    EXPECT_NEAR(found.quiet, quiet, 0.1 * quiet);
  }
}

TEST(ModulatedNoise, HasNoPartThatTheErrorsDeny) {
  // Louder where there is less: no growth. None at all: none.
  const ModulatedNoise even = FitModulatedNoise({4, 4, 1, 1}, {0, 0, 1, 1});
  EXPECT_EQ(even.growth, 0);
  EXPECT_NEAR(even.quiet, std::sqrt(2.5), 0.5);
  const ModulatedNoise none = FitModulatedNoise({0, 0}, {0.1, 0.5});
  EXPECT_EQ(none.growth, 0);
  EXPECT_EQ(none.quiet, 0);
}

}  // namespace
}  // namespace sinew
