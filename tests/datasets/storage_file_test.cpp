#include "datasets/io/storage_file.h"

#include <cmath>

#include "tests/datasets/support.h"

namespace sinew {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST(StorageFile, OpenSimDialect) {
  const auto storage = ParseStorage(
      "Coordinates\nversion=1\nnRows=2\nnColumns=3\ninDegrees=yes\n\nAngles are in degrees.\n\nendheader\n"
      "time\tknee\tankle\n0.0\t1.5\t-2\n0.1\t2.5\t-3e1\n",
      "x.mot");
  ASSERT_TRUE(storage) << ErrorOf(storage);
  EXPECT_EQ(storage->title, "Coordinates");
  EXPECT_EQ(storage->in_degrees, true);
  EXPECT_THAT(storage->time, ElementsAre(0, 0.1));
  EXPECT_THAT(storage->names, ElementsAre("knee", "ankle"));
  EXPECT_THAT(storage->columns[1], ElementsAre(-2, -30));
  EXPECT_THAT(storage->lines, ElementsAre(11, 12));
  EXPECT_EQ(storage->Find("knee"), &storage->columns[0]);
  EXPECT_EQ(storage->Find("hip"), nullptr);
}

TEST(StorageFile, OpenSim4Dialect) {
  const auto storage = ParseStorage(
      "DataType=double\nversion=3\nOpenSimVersion=4.4\nendheader\ntime\t/a/b|c\n0\t1\n", "x.sto");
  ASSERT_TRUE(storage) << ErrorOf(storage);
  EXPECT_EQ(storage->title, "");
  EXPECT_FALSE(storage->in_degrees.has_value());
  EXPECT_THAT(storage->names, ElementsAre("/a/b|c"));
}

TEST(StorageFile, CeinmsAndSimmDialects) {
  const auto ceinms =
      ParseStorage("CEINMS output\ndatacolumns 2\ndatarows 1\nendheader\ntime\tknee\t\n0\t23.5\t\n", "x.sto");
  ASSERT_TRUE(ceinms) << ErrorOf(ceinms);
  EXPECT_EQ(ceinms->title, "CEINMS output");
  EXPECT_THAT(ceinms->names, ElementsAre("knee"));

  const auto simm = ParseStorage(
      "# a comment\nname walk\ndatacolumns 3\ndatarows 2\notherdata 1\nrange 0.0 0.1\nendheader\n"
      "time  knee ankle\n 0.0  1  2\n 0.1  3  4\n",
      "x.mot");
  ASSERT_TRUE(simm) << ErrorOf(simm);
  EXPECT_EQ(simm->title, "walk");
  EXPECT_THAT(simm->columns[1], ElementsAre(2, 4));
}

TEST(StorageFile, BlanksAroundEqualsCarriageReturnsAndTrailingTabs) {
  const auto storage = ParseStorage(
      "grf\t\t\r\n// remark\r\nnRows = 2\t\r\nnColumns =3\t\r\ninDegrees= no\r\nENDHEADER\t\r\n\r\n"
      "time\t  a\t b \r\n0\t1\t2\t\r\n\r\n1\t3\t4\r\n",
      "x.mot");
  ASSERT_TRUE(storage) << ErrorOf(storage);
  EXPECT_EQ(storage->title, "grf");
  EXPECT_EQ(storage->in_degrees, false);
  EXPECT_THAT(storage->names, ElementsAre("a", "b"));
  EXPECT_THAT(storage->lines, ElementsAre(9, 11));
}

TEST(StorageFile, NamesWithBlanksAreCellsBetweenTabs) {
  const auto storage = ParseStorage("x\nendheader\ntime\tleft knee\n0\t1\n", "x.mot");
  ASSERT_TRUE(storage) << ErrorOf(storage);
  EXPECT_THAT(storage->names, ElementsAre("left knee"));
}

TEST(StorageFile, GapsAreNaN) {
  const auto storage =
      ParseStorage("x\nendheader\ntime\ta\tb\n0\tnan\t1\n1\t\t2\n2\t-1.#IND\t3\n3\t4\t\n", "x.mot");
  ASSERT_TRUE(storage) << ErrorOf(storage);
  for (int row = 0; row < 3; ++row) EXPECT_TRUE(std::isnan(storage->columns[0][row])) << row;
  EXPECT_EQ(storage->columns[0][3], 4);
  EXPECT_TRUE(std::isnan(storage->columns[1][3]));
}

// As OpenSim reads them.
TEST(StorageFile, WrongCountsInTheHeaderAreSaidAndDoNotCount) {
  const std::string header = "walk\nversion=1\nnRows=2\nnColumns=3\nendheader\n";
  for (const std::string blank : {"\t", "  "}) {
    const auto fewer = ParseStorage(header + "time" + blank + "a\n0" + blank + "1\n", "x.mot");
    ASSERT_TRUE(fewer) << ErrorOf(fewer);
    EXPECT_THAT(fewer->names, testing::ElementsAre("a"));
    EXPECT_THAT(fewer->columns[0], testing::ElementsAre(1));
    EXPECT_THAT(fewer->notes,
                testing::ElementsAre(
                    "x.mot:6: 2 column names, the header announces 3 columns (line 4); all of them were read",
                    "x.mot:7: the file ends after 1 rows, the header announces 2 rows (line 3); all of them "
                    "were read"));
  }
  const auto more = ParseStorage(header + "time\ta\tb b\n0\t1\t2\n1\t3\t4\n2\t5\t6\n", "x.mot");
  ASSERT_TRUE(more) << ErrorOf(more);
  EXPECT_THAT(more->names, testing::ElementsAre("a", "b b"));
  EXPECT_EQ(more->time.size(), 3U);
  EXPECT_THAT(more->notes,
              testing::ElementsAre(testing::HasSubstr("ends after 3 rows, the header announces 2")));
}

TEST(StorageFile, BadFilesAreErrorsWithTheirLine) {
  const std::string header = "walk\nversion=1\nnRows=2\nnColumns=3\nendheader\n";
  const std::pair<std::string, std::string> cases[] = {
      {"", "x.mot: has no line 'endheader'"},
      {"walk\nnRows=1\ntime\ta\n0\t1\n", "x.mot: has no line 'endheader'"},
      {header, "x.mot: ends after its header"},
      {header + "time\ta\tb\n", "x.mot: has no rows of data"},
      {header + "time\ta\tb\n0\t1\t2\n1\t3\n", "x.mot:8: row has 2 values, the header announces 3 columns"},
      {header + "time\ta\tb\n0\t1\t2\n1\t3\t4\t5\n",
       "x.mot:8: row has 4 values, the header announces 3 columns"},
      {header + "time\ta\n0\t1\t2\n", "x.mot:7: row has 3 values, but 2 columns have a name"},
      {header + "time\ta\ta\n0\t1\t2\n", "x.mot:6: the column name 'a' appears twice"},
      {header + "a\ttime\tb\n0\t1\t2\n", "x.mot:6: the first column is 'a', expected time"},
      {header + "time\ta\tb\n0\t1\t2\n1\tabc\t4\n", "x.mot:8: column 'a': 'abc' is not a number"},
      {header + "time\ta\tb\n0\t1\t2\n1\tinf\t4\n", "x.mot:8: column 'a': 'inf' is not a number"},
      {header + "time\ta\tb\n0\t1\t2\n0\t3\t4\n",
       "x.mot:8: time 0 s does not increase, the row before is at 0 s"},
      {header + "time\ta\tb\n0\t1\t2\nnan\t3\t4\n", "x.mot:8: the time is not a number"},
      {"walk\nnRows=two\nendheader\n", "x.mot:2: nrows is 'two', expected a whole number"},
      {"walk\ninDegrees=maybe\nendheader\n", "x.mot:2: inDegrees is 'maybe', expected yes or no"},
      {"DataType=Vec3\nendheader\n", "x.mot:1: DataType 'Vec3' is not supported, expected double"},
      {"walk\nendheader\ntime\ta\n0\t1\n1\n", "x.mot:5: row has 1 values, but 2 columns have a name"},
  };
  for (const auto& [text, message] : cases) {
    EXPECT_THAT(ErrorOf(ParseStorage(text, "x.mot")), testing::StartsWith(message)) << text;
  }
}

TEST(StorageFile, FilesThatCannotBeReadAreErrors) {
  const TemporaryFolder folder;
  EXPECT_EQ(ErrorOf(ReadStorage(folder.Path("no.mot"))), folder.Path("no.mot") + ": no such file");
  EXPECT_THAT(ErrorOf(ReadStorage(folder.Write("empty.mot", ""))), HasSubstr("empty.mot: is empty"));
  EXPECT_THAT(ErrorOf(ReadStorage(folder.Path(""))), HasSubstr("is a folder"));
  EXPECT_THAT(ErrorOf(ReadStorage(folder.Write("utf16.mot", "\xFF\xFEx"))), HasSubstr("UTF-16"));
}

TEST(StorageFile, WrittenFilesReadBackToTheLastBit) {
  const TemporaryFolder folder;
  Storage storage;
  storage.title = "simulation";
  storage.in_degrees = false;
  storage.time = {0, 1.0 / 3, 0.7000000000000001};
  storage.names = {"right_force_y", "knee_angle_r"};
  storage.columns = {{1.0 / 7, -1e-300, 3e200}, {0, std::nan(""), 0.1 + 0.2}};
  ASSERT_EQ(ErrorOf(WriteStorage(folder.Path("out.sto"), storage)), "");
  const auto read = ReadStorage(folder.Path("out.sto"));
  ASSERT_TRUE(read) << ErrorOf(read);
  EXPECT_EQ(read->title, storage.title);
  EXPECT_EQ(read->in_degrees, storage.in_degrees);
  EXPECT_EQ(read->time, storage.time);
  EXPECT_EQ(read->names, storage.names);
  EXPECT_EQ(read->columns[0], storage.columns[0]);
  EXPECT_TRUE(std::isnan(read->columns[1][1]));
  EXPECT_EQ(read->columns[1][2], storage.columns[1][2]);
  EXPECT_TRUE(read->notes.empty());
}

TEST(StorageFile, WritingColumnsOfUnequalLengthIsAnError) {
  const TemporaryFolder folder;
  Storage storage;
  storage.time = {0, 1};
  storage.names = {"a"};
  EXPECT_THAT(ErrorOf(WriteStorage(folder.Path("out.sto"), storage)), HasSubstr("1 names for 0 columns"));
  storage.columns = {{1}};
  EXPECT_THAT(ErrorOf(WriteStorage(folder.Path("out.sto"), storage)),
              HasSubstr("'a' has 1 values, its time has 2"));
  EXPECT_FALSE(std::filesystem::exists(folder.Path("out.sto")));
  storage.columns = {{1, 2}};
  EXPECT_THAT(ErrorOf(WriteStorage(folder.Path("no/out.sto"), storage)), HasSubstr("cannot be written"));
}

}  // namespace
}  // namespace sinew
