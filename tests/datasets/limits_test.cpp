// Files that are small and would become large: refused before they do.
#include "datasets/io/csv_file.h"
#include "datasets/io/external_loads.h"
#include "datasets/io/import.h"
#include "datasets/io/storage_file.h"
#include "datasets/io/trc_file.h"
#include "tests/datasets/support.h"

namespace sinew {
namespace {

using testing::HasSubstr;

constexpr int kTooMany = 20001;

std::string Names(int count, char separator) {
  std::string names;
  for (int i = 0; i < count; ++i) names += fmt::format("{}c{}", i == 0 ? "" : std::string(1, separator), i);
  return names;
}

TEST(Limits, ColumnsOfTables) {
  EXPECT_EQ(ErrorOf(ParseCsv(Names(kTooMany, ',') + "\n", "x.csv")),
            "x.csv:1: names 20001 columns, expected at most 20000");
  EXPECT_EQ(ErrorOf(ParseStorage("x\nendheader\ntime\t" + Names(kTooMany - 1, '\t') + "\n", "x.mot")),
            "x.mot:3: names 20001 columns, expected at most 20000");
  const std::string markers =
      "PathFileType\t4\nDataRate\tNumFrames\tNumMarkers\tUnits\n60\t1\t20000\tmm\nFrame#\tTime\t" +
      Names(kTooMany - 2, '\t') + "\n";
  EXPECT_EQ(ErrorOf(ParseTrc(markers, "x.trc")), "x.trc:4: has 20001 columns, expected at most 20000");
}

TEST(Limits, ChannelsOfAMap) {
  std::string map = "channels:\n";
  for (int i = 0; i < kTooMany; ++i) map += fmt::format("  c{}: {{column: a, unit: m}}\n", i);
  EXPECT_EQ(ErrorOf(ParseImportMap(map, "m.yaml")), "m.yaml:20002: names more than 20000 channels");
}

// 15,000 channels of one column with 20,000 rows: 2.4 GB from half a megabyte.
TEST(Limits, ChannelsOfOneColumn) {
  std::string map = "time: {column: t, unit: s}\nchannels:\n";
  for (int i = 0; i < 15000; ++i) map += fmt::format("  c{}: {{column: a, unit: m}}\n", i);
  std::string table = "t,a\n";
  for (int i = 0; i < 20000; ++i) table += fmt::format("{},1\n", i);
  const TemporaryFolder folder;
  ImportOptions options;
  options.map = *ParseImportMap(map, "m.yaml");
  Dataset data;
  std::vector<std::string> notes;
  EXPECT_THAT(ErrorOf(ImportFile(folder.Write("a.csv", table), options, data, notes)),
              HasSubstr("a.csv: its channels would have more than 268435456 values"));
  EXPECT_TRUE(data.trials.empty());
}

// Entities of a document type are not replaced, so that nothing grows.
TEST(Limits, EntitiesOfXml) {
  std::string bomb = "<!DOCTYPE a [<!ENTITY l0 \"lol\">";
  for (int i = 1; i < 10; ++i) {
    bomb += fmt::format("<!ENTITY l{} \"", i);
    for (int k = 0; k < 10; ++k) bomb += fmt::format("&l{};", i - 1);
    bomb += "\">";
  }
  bomb +=
      "]><OpenSimDocument><ExternalLoads><ExternalForce "
      "name=\"&l9;\"><applied_to_body>calcn_r</applied_to_body>"
      "<force_identifier>v</force_identifier></ExternalForce></ExternalLoads></OpenSimDocument>";
  const auto forces = ParseExternalLoads(bomb, "x.xml");
  ASSERT_TRUE(forces) << forces.error().message;
  EXPECT_EQ(forces->front().name, "&l9;");
  EXPECT_EQ(ErrorOf(ParseExternalLoads(std::string((std::size_t{1} << 26U) + 1, ' '), "x.xml")),
            "x.xml: has 67108865 bytes, expected at most 67108864");
}

}  // namespace
}  // namespace sinew
