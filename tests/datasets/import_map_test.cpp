#include "datasets/io/import_map.h"

#include "base/constants.h"
#include "tests/datasets/support.h"

namespace sinew {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

TEST(ImportMap, EverythingThatItCanHold) {
  const auto map = ParseImportMap(
      "time: {column: t, unit: ms}\n"
      "channels:\n"
      "  position: {column: qm, unit: deg, scale: -1, sigma: 0.1}\n"
      "  torque: {column: tau, unit: N*m, kind: input}\n"
      "  plain: {unit: V}\n"
      "markers: {R.ASIS: RASI}\n"
      "constants: {gear_ratio: {value: 120, unit: \"1\"}, stroke: {value: 12, unit: mm}}\n"
      "conditions: {speed_rad_per_s: 0.52}\n"
      "title: a test\ntask: swing\n",
      "map.yaml");
  ASSERT_TRUE(map) << ErrorOf(map);
  EXPECT_EQ(map->time->column, "t");
  EXPECT_EQ(map->time->factor, 1e-3);
  const MappedChannel& position = map->channels.at("position");
  EXPECT_EQ(position.column, "qm");
  EXPECT_EQ(position.unit->si_unit, "rad");
  EXPECT_EQ(position.unit->factor, kPi / 180);
  EXPECT_EQ(position.scale, -1);
  EXPECT_EQ(position.sigma, 0.1);
  EXPECT_EQ(position.line, 3);
  EXPECT_FALSE(position.kind);
  EXPECT_EQ(map->channels.at("torque").kind, ChannelKind::kInput);
  EXPECT_EQ(map->channels.at("plain").column, "plain");
  EXPECT_EQ(map->markers.at("R.ASIS").name, "RASI");
  EXPECT_EQ(map->constants.at("gear_ratio").value, 120);
  EXPECT_DOUBLE_EQ(map->constants.at("stroke").value, 0.012);
  EXPECT_EQ(map->constants.at("stroke").unit, "m");
  EXPECT_EQ(map->conditions.at("speed_rad_per_s"), 0.52);
  EXPECT_EQ(map->texts.at("title"), "a test");
}

TEST(ImportMap, BadMapsAreErrorsWithTheirLine) {
  const std::pair<const char*, const char*> cases[] = {
      {"chanels: {}\n", "m.yaml:1: unknown key 'chanels' in the map; did you mean 'channels'?"},
      {"time: {column: t}\nchannels:\n  x: {column: a, unt: m}\n",
       "m.yaml:3: unknown key 'unt' in channel 'x'; did you mean 'unit'?"},
      {"channels:\n  x: {unit: furlong}\n", "m.yaml:2: unknown unit 'furlong'"},
      {"channels:\n  x:\n    unit: m\n    kind: output\n",
       "m.yaml:4: channel 'x': kind is 'output', expected measured or input"},
      {"channels:\n  x: {scale: big}\n", "m.yaml:2: channel 'x': scale is 'big', expected a number"},
      {"channels:\n  x: {scale: 0}\n", "m.yaml:2: channel 'x': scale is 0"},
      {"channels:\n  x: {sigma: -1}\n", "m.yaml:2: channel 'x': sigma is -1"},
      {"channels:\n  x: {column: a}\n  x: {column: b}\n", "m.yaml:3: channels: the key 'x' appears twice"},
      {"channels: [a, b]\n", "m.yaml:1: channels: expected NAME: VALUE pairs"},
      {"time: {unit: s}\n", "m.yaml:1: time has no column"},
      {"time: {column: t, rate: 148}\n", "m.yaml:1: time has a column and a rate, expected one of them"},
      {"time: {rate: 12 Hz}\n", "m.yaml:1: time: rate is '12 Hz', expected a number"},
      {"channels: {x: {time: {unit: s}}}\n", "m.yaml:1: channel 'x': time has no column"},
      {"time: {rate: 0}\n", "m.yaml:1: time: rate is 0, expected samples per second above 0"},
      {"time: {column: t, unit: m}\n", "m.yaml:1: the unit of time is m, expected s or ms"},
      {"constants: {mass: 3}\n", "m.yaml:1: constant 'mass': expected NAME: VALUE pairs"},
      {"constants: {mass: {value: 3}}\n", "m.yaml:1: constant 'mass': expected {value: NUMBER, unit: UNIT}"},
      {"\nconditions: {speed: fast}\n", "m.yaml:2: condition 'speed' is 'fast', expected a number"},
      {"markers: {a: [b]}\n", "m.yaml:1: marker 'a': expected a text"},
      {"time: {column: t\n", "m.yaml:2: not valid YAML"},
      {"just text\n", "m.yaml: is not a map"},
      {"", "m.yaml: is not a map"},
  };
  for (const auto& [text, message] : cases) {
    EXPECT_THAT(ErrorOf(ParseImportMap(text, "m.yaml")), StartsWith(message)) << text;
  }
  EXPECT_THAT(ErrorOf(ReadImportMap("/no/such/map.yaml")), HasSubstr("no such file"));
}

}  // namespace
}  // namespace sinew
