// From MAT files to channels: which variable, which times, which unit.
#include "base/constants.h"
#include "datasets/io/import.h"
#include "datasets/io/mat_path.h"
#include "tests/datasets/support.h"
#include "tests/support/mat_writer.h"

namespace sinew {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

constexpr double kTight = 1e-15;

class MatImport : public testing::Test {
 protected:
  std::string Import(const std::vector<std::string>& paths, const std::string& map) {
    ImportOptions options;
    const auto read = ParseImportMap(map, "m.yaml");
    if (!read) return ErrorOf(read);
    options.map = *read;
    data_ = Dataset();
    notes_.clear();
    return ErrorOf(ImportFiles(paths, options, data_, notes_));
  }
  [[nodiscard]] const Trial& trial() const { return data_.trials.at("walk"); }
  [[nodiscard]] std::string path() const { return folder_.Path("walk.mat"); }

  TemporaryFolder folder_;
  Dataset data_;
  std::vector<std::string> notes_;
};

class MatImportOf : public MatImport, public testing::WithParamInterface<MatLayout> {};

INSTANTIATE_TEST_SUITE_P(AllLayouts, MatImportOf,
                         testing::Values(MatLayout::k5, MatLayout::k5Compressed, MatLayout::k73),
                         [](const auto& layout) { return NameOf(layout.param); });

TEST_P(MatImportOf, ChannelsOfSpike2BringTheirTimesAndUnits) {
  MatWriter(path(), GetParam())
      .Spike2("Ch1", "Angle", "Deg", 0.01, 0.002, {90, 0, -90})
      .Spike2("Ch2", "Torque", "Nm", 0.01, 0.002, {1, 2, 3})
      .Spike2("Ch3", "EMG TA", "mV", 0.005, 0.001, {1, std::nan(""), 3, 4})
      .Struct("Frames", {{"title", std::string("US")}, {"times", std::vector<double>{0.5, 0.7}}});
  ASSERT_EQ(
      Import(
          {path()},
          "channels:\n  angle: {column: Ch1, scale: -1, sigma: 2, kind: input}\n  torque: {column: Torque}\n"
          "  tib_ant: {column: EMG TA}\n  frame: {column: US}\n"),
      "");
  ASSERT_EQ(trial().grids.size(), 3U);
  const Grid& machine = trial().grids.at("angle");
  ASSERT_EQ(machine.time.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_NEAR(machine.time[i], 0.002 + 0.01 * static_cast<double>(i), kTight);
  EXPECT_THAT(machine.channels.at("angle").values, ElementsAre(-kPi / 2, 0, kPi / 2));
  EXPECT_EQ(machine.channels.at("angle").unit, "rad");
  EXPECT_EQ(machine.channels.at("angle").kind, ChannelKind::kInput);
  EXPECT_DOUBLE_EQ(*machine.channels.at("angle").sigma, 2 * kPi / 180);
  EXPECT_EQ(machine.channels.at("torque").unit, "N*m");
  const Grid& emg = trial().grids.at("tib_ant");
  EXPECT_EQ(emg.time.size(), 4U);
  EXPECT_EQ(emg.channels.at("tib_ant").values[0], 1e-3);
  EXPECT_TRUE(std::isnan(emg.channels.at("tib_ant").values[1])) << "a gap stays a gap";
  EXPECT_THAT(trial().grids.at("frame").time, ElementsAre(0.5, 0.7));
  EXPECT_THAT(trial().grids.at("frame").channels.at("frame").values, ElementsAre(1, 1));
}

TEST_P(MatImportOf, ArraysTakeTheirTimesFromTheMap) {
  MatWriter(path(), GetParam())
      .Column("t", {0, 10, 25})
      .Array("data", 3, 2, {1, 2, 3, 4, 5, 6})
      .Array("wide", 2, 3, {1, 10, 2, 20, 3, 30})
      .Column("fs", {50})
      .Column("fast", {1, 2, 3, 4})
      .StructArray("Fdat", "Region", "FL", {{1, 2, 3}, {7, 8, 9}})
      .Cells("trials", {{1, 2, 3}, {4, 5, 6}});
  ASSERT_EQ(Import({path()},
                   "time: {column: t, unit: ms}\n"
                   "channels:\n"
                   "  a: {column: 'data(:,2)', unit: m}\n"
                   "  b: {column: 'wide(2,:)', unit: mm}\n"
                   "  c: {column: fast, unit: V, time: {rate: fs}}\n"
                   "  d: {column: Fdat.Region(2).FL, unit: cm}\n"
                   "  e: {column: 'trials{2}', unit: N}\n"),
            "");
  const Grid& slow = trial().grids.at("a");
  EXPECT_THAT(slow.time, ElementsAre(0, 0.01, 0.025));
  EXPECT_THAT(slow.channels.at("a").values, ElementsAre(4, 5, 6));
  EXPECT_THAT(slow.channels.at("b").values, ElementsAre(0.01, 0.02, 0.03));
  EXPECT_THAT(slow.channels.at("d").values, ElementsAre(0.07, 0.08, 0.09));
  EXPECT_THAT(slow.channels.at("e").values, ElementsAre(4, 5, 6));
  EXPECT_THAT(trial().grids.at("c").time, ElementsAre(0, 0.02, 0.04, 0.06));
}

TEST_F(MatImport, OneClockIsOneGridNamedAfterTheFile) {
  MatWriter(path(), MatLayout::k5).Column("q", {1, 2, 3});
  ASSERT_EQ(Import({path()}, "time: {rate: 100}\nchannels: {q: {unit: rad}}\n"), "");
  EXPECT_THAT(trial().grids.at("walk").time, ElementsAre(0, 0.01, 0.02));
}

TEST_F(MatImport, TheSecondFileCanHaveTheTimesOfTheFirst) {
  MatWriter(path(), MatLayout::k73).Struct("US", {{"times", std::vector<double>{1, 2}}}).Column("other", {1});
  MatWriter(folder_.Path("more.mat"), MatLayout::k5Compressed)
      .StructArray("Fdat", "Region", "FL", {{64, 65}});
  ASSERT_EQ(Import({path(), folder_.Path("more.mat")},
                   "channels: {length: {column: Fdat.Region.FL, unit: mm, time: {column: US}}}\n"),
            "");
  EXPECT_THAT(trial().grids.at("walk").time, ElementsAre(1, 2));
  EXPECT_THAT(trial().grids.at("walk").channels.at("length").values, ElementsAre(0.064, 0.065));
  EXPECT_THAT(notes_, ElementsAre(HasSubstr("variables that the map does not name were left out: other")));
}

TEST_F(MatImport, IntegersOfSpike2AreScaled) {
  MatWriter(path(), MatLayout::k5)
      .Struct("Ch", {{"interval", std::vector<double>{1}},
                     {"scale", std::vector<double>{0.5}},
                     {"offset", std::vector<double>{10}},
                     {"length", std::vector<double>{9}},
                     {"values", std::vector<std::int16_t>{-2, 4}}});
  ASSERT_EQ(Import({path()}, "channels: {q: {column: Ch, unit: N}}\n"), "");
  EXPECT_THAT(trial().grids.at("walk").channels.at("q").values, ElementsAre(9, 12));
  EXPECT_THAT(notes_, ElementsAre(HasSubstr("multiplied by its scale, 0.5, and its offset added, 10"),
                                  HasSubstr("has 2 values, its length says 9; all of them were read")));
}

TEST_F(MatImport, ValuesWithTimesOfTheirOwnAreIrregular) {
  MatWriter(path(), MatLayout::k5)
      .Struct("Ch", {{"times", std::vector<double>{0, 0.1, 0.4}}, {"values", std::vector<double>{3, 4, 5}}})
      .Struct("Bad", {{"times", std::vector<double>{0, 0.1}}, {"values", std::vector<double>{3, 4, 5}}})
      .Struct("Back", {{"times", std::vector<double>{0, 0.2, 0.1}}, {"values", std::vector<double>{3, 4, 5}}})
      .Struct("None", {{"times", std::vector<double>{}}});
  ASSERT_EQ(Import({path()}, "channels: {q: {column: Ch, unit: N}}\n"), "");
  EXPECT_THAT(trial().grids.at("walk").time, ElementsAre(0, 0.1, 0.4));
  EXPECT_THAT(Import({path()}, "channels: {q: {column: Bad, unit: N}}\n"),
              HasSubstr("Bad has 3 values and 2 times"));
  EXPECT_THAT(Import({path()}, "channels: {q: {column: Back, unit: N}}\n"),
              HasSubstr("Back.times: element 3 (0.1 s) does not increase, the one before is 0.2 s"));
  EXPECT_THAT(Import({path()}, "channels: {q: {column: None}}\n"), HasSubstr("None.times is empty"));
}

TEST_F(MatImport, WhatCannotBeAChannelIsOneErrorWithItsPlace) {
  MatWriter(path(), MatLayout::k5)
      .Spike2("Torque", "Torque", "Nm", 0.01, 0, {1, 2})
      .Spike2("Torque2", "EMG", "V", 0.01, 0, {1, 2})
      .Spike2("Torque3", "EMG", "furlong", 0.01, 0, {1, 2})
      .Spike2("Stopped", "Stopped", "V", 0, 0, {1, 2})
      .Column("x", {1, 2})
      .Column("long_one", {1, 2, 3})
      .Column("infinite", {1, INFINITY})
      .Array("matrix", 3, 2, {1, 2, 3, 4, 5, 6})
      .Text("words", "hello")
      .StructArray("Fdat", "Region", "FL", {{1, 2}, {3, 4}})
      .Cells("cells", {{1}})
      .Complex("complex")
      .Sparse("sparse")
      .Array("nothing", 0, 0, {});
  const std::string file = path();
  const std::pair<std::string, std::string> cases[] = {
      {"channels: {q: {column: Torqe}}",
       "m.yaml:1: " + file + " has no variable and no title 'Torqe'; there are Torque, Torque2, Torque3"},
      {"channels: {q: {column: Torque.vals}}",
       "m.yaml:1: " + file + ": Torque has no field 'vals'; there are values, scale"},
      {"channels: {q: {column: EMG}}",
       "m.yaml:1: two channels of " + file + " have the title 'EMG': Torque2 and Torque3; name the variable"},
      {"channels: {q: {column: Torque3}}", "m.yaml:1: channel 'q' has no unit, and that of " + file +
                                               ": Torque3 is not known: unknown unit 'furlong'"},
      {"channels: {q: {column: Stopped}}",
       file + ": Stopped: interval is 0 s and start 0 s, expected an interval"},
      {"channels: {q: {column: x, unit: m}}",
       "m.yaml:1: channel 'q': " + file +
           ": x does not say when its samples were taken; expected for example time"},
      {"time: {rate: 10}\nchannels: {q: {column: x}}",
       "m.yaml:2: channel 'q' has no unit; " + file + ": x does not contain it (1 if there is none)"},
      {"time: {column: x, unit: s}\nchannels: {q: {column: long_one, unit: m}}",
       "m.yaml:1: channel 'q': " + file + ": long_one has 3 values, 'x' has 2 times"},
      {"time: {rate: long_one}\nchannels: {q: {column: x, unit: m}}",
       file + ": long_one is 3 numbers, expected samples per second above 0"},
      {"time: {column: infinite}\nchannels: {q: {column: x, unit: m}}",
       file + ": infinite: element 2 is inf, expected a time"},
      {"time: {rate: 1}\nchannels: {q: {column: infinite, unit: m}}",
       file + ": infinite: element 2 is infinite; a gap is NaN"},
      {"time: {rate: 1}\nchannels: {q: {column: matrix, unit: m}}",
       file + ": matrix has 3 x 2 numbers, expected a vector; name a column of it: (:,1) to (:,2)"},
      {"time: {rate: 1}\nchannels: {q: {column: 'matrix(:,3)', unit: m}}",
       file + ": matrix has 3 x 2 numbers: there is no column 3"},
      {"time: {rate: 1}\nchannels: {q: {column: words, unit: m}}",
       file + ": words is 1 x 5 text, expected a vector of numbers"},
      {"time: {rate: 1}\nchannels: {q: {column: Fdat, unit: m}}",
       "m.yaml:1: " + file +
           ": Fdat is 1 x 1 struct without values and interval or times; name one of its fields: "
           "Region"},
      {"time: {rate: 1}\nchannels: {q: {column: Fdat.Region.FL, unit: m}}",
       "m.yaml:2: " + file + ": Fdat.Region is 1 x 2 struct, expected which of them: Fdat.Region(1).FL"},
      {"time: {rate: 1}\nchannels: {q: {column: Fdat.Region(3).FL, unit: m}}",
       "m.yaml:2: " + file + ": Fdat.Region is 1 x 2 struct, it has no element 3"},
      {"time: {rate: 1}\nchannels: {q: {column: x.y, unit: m}}",
       "m.yaml:2: " + file + ": x is 2 x 1 numbers, it has no field 'y'"},
      {"time: {rate: 1}\nchannels: {q: {column: x(1), unit: m}}",
       "m.yaml:2: " + file + ": x is 2 x 1 numbers; a column of a matrix is written as (:,1)"},
      {"time: {rate: 1}\nchannels: {q: {column: cells, unit: m}}",
       file + ": cells is 1 x 1 cells, expected a vector"},
      {"time: {rate: 1}\nchannels: {q: {column: complex, unit: m}}",
       file + ": complex is complex, expected real"},
      {"time: {rate: 1}\nchannels: {q: {column: sparse, unit: m}}",
       file + ": sparse is sparse, expected a full"},
      {"time: {rate: 1}\nchannels: {q: {column: nothing, unit: m}}",
       file + ": nothing is empty, expected a vector"},
      {"title: nothing\n", "m.yaml: names no channels for " + file},
  };
  for (const auto& [map, message] : cases) {
    std::string expected = message;
    if (map.rfind("time: {rate: 1}", 0) == 0 && expected.rfind("m.yaml:1", 0) == 0) expected[7] = '2';
    EXPECT_THAT(Import({path()}, map), StartsWith(expected)) << map;
    EXPECT_TRUE(data_.trials.empty());
  }
}

TEST_F(MatImport, WithoutAMapTheErrorListsTheVariables) {
  MatWriter(path(), MatLayout::k73)
      .Spike2("Torque", "Torque", "Nm", 0.01, 0, {1, 2})
      .Array("m", 3, 2, {1, 2, 3, 4, 5, 6});
  EXPECT_EQ(
      ErrorOf(ImportFile(path(), {}, data_, notes_)),
      path() +
          ": needs a map that assigns its variables to channels (they are Torque (1 x 1 struct), m (3 x 2 "
          "numbers))");
}

TEST_F(MatImport, AVariableInTwoFilesIsAnError) {
  MatWriter(path(), MatLayout::k5).Column("x", {1});
  MatWriter(folder_.Path("more.mat"), MatLayout::k5).Column("x", {1});
  EXPECT_THAT(Import({path(), folder_.Path("more.mat")}, "time: {rate: 1}\nchannels: {x: {unit: m}}\n"),
              HasSubstr("have a variable 'x' both, expected it in one of them"));
}

TEST_F(MatImport, AUnitThatTheFileStatesOtherwiseIsNoted) {
  MatWriter(path(), MatLayout::k5).Spike2("a", "a", "Deg", 1, 0, {1}).Spike2("b", "b", "V", 1, 0, {1});
  ASSERT_EQ(Import({path()}, "channels: {a: {unit: deg}, b: {unit: N, scale: 50}}\n"), "");
  EXPECT_THAT(notes_,
              ElementsAre(HasSubstr("b: states the unit 'V'; that of the map was taken for channel 'b'")));
}

TEST(MatPath, ReadsAddressesOfMatlab) {
  const auto path = ParseMatPath("Fdat.Region(2).FL(:, 3)");
  ASSERT_TRUE(path);
  EXPECT_EQ(path->variable, "Fdat");
  ASSERT_EQ(path->steps.size(), 4U);
  EXPECT_EQ(path->steps[0].name, "Region");
  EXPECT_EQ(path->steps[1].index, 1U);
  EXPECT_EQ(path->steps[1].written, "Fdat.Region(2)");
  EXPECT_EQ(path->steps[3].kind, MatStep::Kind::kColumn);
  EXPECT_EQ(path->steps[3].index, 2U);
  for (const char* none : {"", "EMG TA", "2x", "a..b", "a(", "a(0)", "a(:)", "a(1,2)", "a(:,1).b", "a{x}",
                           "a(1", "a-b", "a(99999999999)"})
    EXPECT_FALSE(ParseMatPath(none)) << none;
}

}  // namespace
}  // namespace sinew
