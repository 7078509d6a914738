#include "datasets/io/csv_file.h"

#include <cmath>

#include "tests/datasets/support.h"

namespace sinew {
namespace {

using testing::ElementsAre;
using testing::StartsWith;

TEST(CsvFile, CommaSemicolonAndTab) {
  for (const char* text : {"t,x\n0,1.5\n1,2.5\n", "t;x\n0;1,5\n1;2.5\n", "t\tx\n0\t1.5\n1\t2,5\n"}) {
    const auto table = ParseCsv(text, "x.csv");
    ASSERT_TRUE(table) << ErrorOf(table);
    ASSERT_EQ(table->columns.size(), 2U) << text;
    EXPECT_THAT(table->columns[1].values, ElementsAre(1.5, 2.5)) << text;
    EXPECT_EQ(table->columns[1].decimals, 1) << text;
  }
}

TEST(CsvFile, QuotesCommentsCarriageReturnsAndByteOrderMark) {
  const TemporaryFolder folder;
  const auto table =
      ReadCsv(folder.Write("x.csv",
                           "\xEF\xBB\xBF# made by a logger\r\n\r\n"
                           "\"time, s\",\"the \"\"x\"\"\"\r\n0,\"1.5\"\r\n# pause\r\n1,2.5,\r\n"));
  ASSERT_TRUE(table) << ErrorOf(table);
  EXPECT_EQ(table->header_line, 3);
  EXPECT_EQ(table->columns[0].name, "time, s");
  EXPECT_EQ(table->columns[1].name, "the \"x\"");
  EXPECT_THAT(table->columns[1].values, ElementsAre(1.5, 2.5));
  EXPECT_THAT(table->lines, ElementsAre(4, 6));
}

TEST(CsvFile, EmptyCellsAndNaNAreGapsAndTextIsRemembered) {
  const auto table = ParseCsv("t,x,mode\n0,,on\n1,NaN,off\n2,3,\n", "x.csv");
  ASSERT_TRUE(table) << ErrorOf(table);
  EXPECT_TRUE(std::isnan(table->columns[1].values[0]));
  EXPECT_TRUE(std::isnan(table->columns[1].values[1]));
  EXPECT_EQ(table->columns[1].values[2], 3);
  EXPECT_FALSE(table->columns[1].text);
  ASSERT_TRUE(table->columns[2].text);
  EXPECT_EQ(table->columns[2].text->line, 2);
  EXPECT_EQ(table->columns[2].text->cell, "on");
}

TEST(CsvFile, BadFilesAreErrorsWithTheirLine) {
  const std::pair<const char*, const char*> cases[] = {
      {"", "x.csv: is empty"},
      {"# nothing\n\n", "x.csv: is empty"},
      {"t,x\n", "x.csv: has no rows of data"},
      {"0,1\n1,2\n", "x.csv:1: holds numbers, expected the names of the columns"},
      {"t,x\n0,1\n1\n", "x.csv:3: row has 1 cells, the header (line 1) names 2 columns"},
      {"t,x\n0,1,2\n", "x.csv:2: row has 3 cells, the header (line 1) names 2 columns"},
      {"t,x\n0,\"1\n", "x.csv:2: a double quote is not closed"},
  };
  for (const auto& [text, message] : cases)
    EXPECT_THAT(ErrorOf(ParseCsv(text, "x.csv")), StartsWith(message)) << text;
}

}  // namespace
}  // namespace sinew
