#include "problems/emg_shape/settings.h"

#include <gtest/gtest.h>

#include "tests/identify/support/error_of.h"

namespace sinew {
namespace {

Result<EmgShapeSettings> Read(const std::string& lines) {
  SINEW_ASSIGN(const YamlReader yaml,
               YamlReader::Parse("emg_shape:\n  angle: knee\n" + lines, "emg_shape.yaml"));
  SINEW_ASSIGN(const YamlReader section, yaml.At("emg_shape"));
  return ReadEmgShapeSettings(section);
}

TEST(EmgShapeSettings, EverythingIsRead) {
  const auto read = Read(
      "  muscles: [a, b]\n  model: averaging\n  cycles: {begins_at: lowest, swing: 0.4, shortest: 0.5}\n"
      "  laws: [lead]\n  timing: shared\n  cycle_scatter: false\n  knots: 20\n  rate: 50\n  same_speed: 0.1\n"
      "  hold_out: [fast]\n  reference: {speed: 1.2, period: 0.9}\n");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->angle, "knee");
  EXPECT_EQ(read->muscles, (std::vector<std::string>{"a", "b"}));
  EXPECT_EQ(read->model, EmgShapeModel::kAveraging);
  EXPECT_EQ(read->cycles.begins_at, CycleBegin::kLowest);
  EXPECT_EQ(read->cycles.swing, 0.4);
  EXPECT_EQ(read->cycles.shortest_s, 0.5);
  EXPECT_FALSE(read->amplitude_law);
  EXPECT_TRUE(read->lead_law);
  EXPECT_FALSE(read->timing_per_muscle);
  EXPECT_FALSE(read->cycle_scatter);
  EXPECT_EQ(read->knots, 20);
  EXPECT_EQ(read->hold_out, std::vector<std::string>{"fast"});
  EXPECT_EQ(read->reference->period, 0.9);
}

TEST(EmgShapeSettings, MistakesHaveALine) {
  EXPECT_EQ(ErrorOf(Read("  knots: 3\n")), "emg_shape.yaml:3: knots: 3, expected 4 to 200");
  EXPECT_EQ(ErrorOf(Read("  knots: 4.5\n")), "emg_shape.yaml:3: knots: 4.5, expected a whole number");
  EXPECT_EQ(ErrorOf(Read("  model: shapes\n")), "emg_shape.yaml:3: model: 'shapes'; did you mean 'shape'?");
  EXPECT_EQ(ErrorOf(Read("  laws: [led]\n")), "emg_shape.yaml:3: laws: 'led'; did you mean 'lead'?");
  EXPECT_EQ(ErrorOf(Read("  muscles: [a, a]\n")), "emg_shape.yaml:3: muscles: 'a' comes twice");
  EXPECT_EQ(ErrorOf(Read("  muscles: []\n")), "emg_shape.yaml:3: muscles: none, expected at least one");
  EXPECT_EQ(ErrorOf(Read("  cycles: {swing: 2}\n")), "emg_shape.yaml:3: swing: 2, expected 0.05 to 0.9");
  EXPECT_NE(ErrorOf(Read("  reference: {speed: 1}\n")), "");
  EXPECT_NE(ErrorOf(Read("  knobs: 3\n")).find("did you mean 'knots'?"), std::string::npos);
}

}  // namespace
}  // namespace sinew
