#include "identify/observation/input_sensor.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/identify/support/error_of.h"

namespace sinew {
namespace {

TEST(InputSensor, HasFiveEffectsThatVanishAtTheirNull) {
  std::vector<Parameter> parameters(3);
  for (std::size_t i = 0; i < 3; ++i) parameters[i].name = "before" + std::to_string(i);
  std::vector<Effect> effects;
  const InputSensor sensor = AddInputSensor("torque", "N*m", 40, 20, parameters, effects);
  EXPECT_EQ(ErrorOf(CheckParameters(parameters)), "");
  ASSERT_EQ(parameters.size(), 8U);
  ASSERT_EQ(effects.size(), 5U);
  EXPECT_EQ(sensor.offset, 3);
  EXPECT_EQ(parameters[static_cast<std::size_t>(sensor.drift)].unit, "N*m/s");
  EXPECT_EQ(parameters[static_cast<std::size_t>(sensor.drift)].upper, 2);
  EXPECT_EQ(parameters[static_cast<std::size_t>(sensor.low_pass)].lower, 0);
  Vector rest(8);
  for (std::size_t i = 0; i < 8; ++i) rest[static_cast<Eigen::Index>(i)] = parameters[i].rest_value();
  for (const Effect& effect : effects) {
    const Parameter& p = parameters[static_cast<std::size_t>(effect.parameters.at(0))];
    EXPECT_EQ(p.effect, effect.name);
    EXPECT_EQ(effect.level, Level::kSensor);
    EXPECT_EQ(effect.description, "torque: " + p.meaning);
    EXPECT_FALSE(effect.revealing_experiment.empty());
  }
  EXPECT_EQ(CorrectedInput(sensor.At(rest), 7.0, 1.2345, 88.0), 1.2345);
}

TEST(InputSensor, RecoversASineFromItsReading) {
  // The reading of a sine through a lag, then late, then with gain, offset and drift, in closed form.
  constexpr double kRounding = 1e-14;
  constexpr double kRate = 5;  // [rad/s]
  const InputCorrection<double> sensor{0.3, -0.02, 1.2, 0.04, 0.05};
  const double lag = std::atan(kRate * sensor.low_pass);
  for (double t = 0; t < 4; t += 0.1) {
    const double from_middle = t - 2;
    // At t + time_offset the reading shows what was there at t; drift counts from the time it is read for.
    const double phase = kRate * t - lag;
    const double reading =
        sensor.gain * std::cos(lag) * std::sin(phase) + sensor.offset + sensor.drift * from_middle;
    const double slope = sensor.gain * std::cos(lag) * kRate * std::cos(phase);
    EXPECT_NEAR(CorrectedInput(sensor, from_middle, reading, slope), std::sin(kRate * t), 10 * kRounding);
  }
}

}  // namespace
}  // namespace sinew
