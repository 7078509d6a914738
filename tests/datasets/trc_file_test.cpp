#include "datasets/io/trc_file.h"

#include <cmath>

#include "tests/datasets/support.h"

namespace sinew {
namespace {

using testing::ElementsAre;
using testing::StartsWith;

constexpr double kDecimalRounding = 1e-12;  // s and m; decimal fractions in binary

std::string Trc(const std::string& frames, const std::string& units = "mm", int count = 2) {
  return "PathFileType\t4\t(X/Y/Z)\twalk.trc\n"
         "DataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\tOrigDataRate\n"
         "60.00\t60.00\t " +
         std::to_string(count) + "\t2\t" + units +
         "\t60.00\n"
         "Frame#\tTime\tR.ASIS\t\t\tL Heel\t\t\n"
         "\t\tX1\tY1\tZ1\tX2\tY2\tZ2\n\n" +
         frames;
}

TEST(TrcFile, PositionsAreInMetres) {
  const auto trc = ParseTrc(Trc("1\t0.0\t1000\t2000\t3000\t4\t5\t6\n2\t0.1\t7\t8\t9\t10\t11\t12\n"), "x.trc");
  ASSERT_TRUE(trc) << ErrorOf(trc);
  ASSERT_EQ(trc->markers.size(), 2U);
  EXPECT_EQ(trc->data_rate_Hz, 60);
  EXPECT_EQ(trc->markers[1].name, "L Heel");
  ASSERT_EQ(trc->markers[0].position.rows(), 2);
  ASSERT_EQ(trc->markers[0].position.cols(), 3);
  EXPECT_NEAR(trc->markers[0].position(0, 2), 3, kDecimalRounding);
  EXPECT_NEAR(trc->markers[1].position(1, 0), 0.01, kDecimalRounding);
  EXPECT_THAT(trc->lines, ElementsAre(7, 8));
}

TEST(TrcFile, UnitsAreConverted) {
  for (const auto& [unit, metres] : {std::pair("m", 7.0), std::pair("cm", 0.07), std::pair("mm", 0.007)}) {
    const auto trc = ParseTrc(Trc("1\t0.0\t7\t8\t9\t10\t11\t12\n", unit, 1), "x.trc");
    ASSERT_TRUE(trc) << ErrorOf(trc);
    EXPECT_NEAR(trc->markers[0].position(0, 0), metres, kDecimalRounding) << unit;
  }
}

TEST(TrcFile, BlankCellsAreGaps) {
  const auto trc = ParseTrc(Trc("1\t0.0\t\t\t\t4\t5\t6\r\n2\t0.1\t7\t8\t9\t\t\t\t\r\n"), "x.trc");
  ASSERT_TRUE(trc) << ErrorOf(trc);
  EXPECT_TRUE(std::isnan(trc->markers[0].position(0, 0)));
  EXPECT_TRUE(std::isnan(trc->markers[1].position(1, 2)));
  EXPECT_FALSE(std::isnan(trc->markers[1].position(0, 2)));
}

TEST(TrcFile, RoundedTimesAreRebuiltFromDataRateAndFrameNumbers) {
  const std::string cells = "\t1\t2\t3\t4\t5\t6\n";
  const auto trc = ParseTrc(
      Trc("31\t0.500000" + cells + "32\t0.517000" + cells + "33\t0.533000" + cells + "36\t0.583000" + cells,
          "mm", 4),
      "x.trc");
  ASSERT_TRUE(trc) << ErrorOf(trc);
  const double expected[] = {30 / 60.0, 31 / 60.0, 32 / 60.0, 35 / 60.0};
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(trc->time[i], expected[i], kDecimalRounding) << i;
  EXPECT_THAT(trc->notes,
              ElementsAre("x.trc: times are rounded to 0.001 s; they were rebuilt at 60 Hz from 0.5 s"));
}

TEST(TrcFile, ARateThatContradictsTheTimesIsReported) {
  const std::string cells = "\t1\t2\t3\t4\t5\t6\n";
  const auto trc = ParseTrc(Trc("1\t0" + cells + "2\t0.01" + cells), "x.trc");
  ASSERT_TRUE(trc) << ErrorOf(trc);
  EXPECT_THAT(trc->time, ElementsAre(0, 0.01));
  EXPECT_THAT(trc->notes,
              ElementsAre("x.trc: DataRate is 60 Hz, but the times have 100 Hz; the times were kept"));
}

TEST(TrcFile, FewerFramesThanAnnouncedAreSaidAndRead) {
  const auto trc = ParseTrc(Trc("1\t0.0\t1\t2\t3\t4\t5\t6\n"), "x.trc");
  ASSERT_TRUE(trc) << ErrorOf(trc);
  EXPECT_EQ(trc->time.size(), 1U);
  EXPECT_EQ(trc->markers[0].position.rows(), 1);
  EXPECT_THAT(trc->notes,
              ElementsAre("x.trc:7: the file ends after 1 frames, the header announces 2 (line 3); "
                          "all of them were read"));
}

TEST(TrcFile, BadFilesAreErrorsWithTheirLine) {
  const std::string frame = "1\t0.0\t1\t2\t3\t4\t5\t6\n";
  auto replaced = [&](const std::string& from, const std::string& to) {
    std::string text = Trc(frame, "mm", 1);
    text.replace(text.find(from), from.size(), to);
    return text;
  };
  const std::pair<std::string, std::string> cases[] = {
      {"", "x.trc: ends after line 0, expected a line that starts with PathFileType"},
      {"Coordinates\nversion=1\n", "x.trc:1: starts with 'Coordinates', expected PathFileType"},
      {"PathFileType\t4\n", "x.trc: ends after line 1"},
      {replaced("DataRate\t", "Rate\t"), "x.trc:2: lacks DataRate"},
      {replaced("60.00\t60.00", "zero\t60.00"), "x.trc:3: DataRate is 'zero'"},
      {replaced("\t2\tmm", "\t3\tmm"),
       "x.trc:4: 2 marker names, the header announces 3 (NumMarkers, line 3)"},
      {replaced("\tmm\t", "\tinch\t"), "x.trc:3: Units is 'inch', expected m, cm or mm"},
      {replaced("\tmm\t", "\tkg\t"), "x.trc:3: Units is 'kg', expected m, cm or mm"},
      {replaced("L Heel", "R.ASIS"), "x.trc:4: the marker name 'R.ASIS' appears twice"},
      {replaced("\t\tX1", "\t\tQ1"), "x.trc:5: starts with"},
      {replaced("\t3\t4\t5\t6\n", "\t3\t4\n"),
       "x.trc:7: row has 6 cells, expected 8: frame, time and 3 for each of 2"},
      {replaced("\t4\t5\t6\n", "\tabc\t5\t6\n"), "x.trc:7: marker 'L Heel': 'abc' is not a number"},
      {replaced("1\t0.0\t", "one\t0.0\t"), "x.trc:7: the frame number is 'one'"},
      {Trc(frame + frame, "mm", 1), "x.trc:8: one frame more than the 1 that the header announces"},
      {Trc("1\t0.5\t1\t2\t3\t4\t5\t6\n2\t0.25\t1\t2\t3\t4\t5\t6\n"),
       "x.trc:8: time 0.25 s does not increase, the row before is at 0.5 s"},
      {Trc(""), "x.trc: has no frames"},
  };
  for (const auto& [text, message] : cases) {
    EXPECT_THAT(ErrorOf(ParseTrc(text, "x.trc")), StartsWith(message)) << text;
  }
}

}  // namespace
}  // namespace sinew
