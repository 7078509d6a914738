#include "base/mat_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hdf5.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "base/random.h"
#include "tests/support/mat_writer.h"

namespace sinew {
namespace {

using ::testing::HasSubstr;

class MatFolder : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() / ("sinew_mat_" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  std::string Path(const std::string& name) { return (folder_ / name).string(); }

  std::string Write(const std::string& name, const std::string& bytes) {
    std::ofstream(Path(name), std::ios::binary) << bytes;
    return Path(name);
  }
  static std::string Bytes(const std::string& path) {
    std::ifstream whole(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(whole), {}};
  }
  static std::string ErrorOf(const std::string& path, const std::set<std::string>& wanted = {"x"}) {
    const auto read = ReadMat(path, wanted);
    return read ? std::string() : read.error().message;
  }

  std::filesystem::path folder_;
};

class MatFileOf : public MatFolder, public ::testing::WithParamInterface<MatLayout> {};

INSTANTIATE_TEST_SUITE_P(AllLayouts, MatFileOf,
                         ::testing::Values(MatLayout::k5, MatLayout::k5Compressed, MatLayout::k73),
                         [](const auto& layout) { return NameOf(layout.param); });

TEST_P(MatFileOf, KeepsNumbersTextStructsAndCells) {
  MatWriter(Path("a.mat"), GetParam())
      .Array("matrix", 2, 3, {1, 2, 3, 4, 5, 6})
      .Text("text", "Nm")
      .Struct("s", {{"values", std::vector<std::int16_t>{1, -2, 3}}, {"title", std::string("EMG")}})
      .StructArray("Fdat", "Region", "FL", {{1, 2}, {3, 4}})
      .Cells("cells", {{1, 2, 3}, {4}})
      .Column("unread", {1, 2});
  const auto read = ReadMat(Path("a.mat"), {"matrix", "text", "s", "Fdat", "cells"});
  ASSERT_TRUE(read) << read.error().message;
  const MatValue& matrix = read->variables.at("matrix");
  EXPECT_EQ(matrix.shape, (std::vector<std::size_t>{2, 3}));
  EXPECT_EQ(matrix.numbers, (std::vector<double>{1, 2, 3, 4, 5, 6}));
  EXPECT_FALSE(matrix.integers);
  EXPECT_EQ(matrix.Describe(), "2 x 3 numbers");
  EXPECT_EQ(read->variables.at("text").kind, MatKind::kText);
  EXPECT_EQ(read->variables.at("text").text, "Nm");
  const MatValue& s = read->variables.at("s");
  EXPECT_EQ(s.Field("values")->numbers, (std::vector<double>{1, -2, 3}));
  EXPECT_TRUE(s.Field("values")->integers);
  EXPECT_EQ(s.Field("title")->text, "EMG");
  EXPECT_EQ(s.Field("times"), nullptr);
  const MatValue* region = read->variables.at("Fdat").Field("Region");
  ASSERT_NE(region, nullptr);
  EXPECT_EQ(region->count(), 2U);
  EXPECT_EQ(region->Field("FL", 1)->numbers, (std::vector<double>{3, 4}));
  EXPECT_EQ(region->Field("FL", 2), nullptr);
  EXPECT_EQ(read->variables.at("cells").elements.at(0).numbers, (std::vector<double>{1, 2, 3}));
  EXPECT_TRUE(read->variables.at("unread").numbers.empty());
  EXPECT_EQ(read->variables.at("unread").count(), 2U);
}

TEST_P(MatFileOf, ReadsWhatHasATitleIfAWantedNameIsNoVariable) {
  MatWriter(Path("a.mat"), GetParam()).Spike2("Ch1", "EMG", "V", 1e-3, 0, {1, 2}).Column("x", {1});
  const auto named = ReadMat(Path("a.mat"), {"x"});
  ASSERT_TRUE(named) << named.error().message;
  EXPECT_TRUE(named->variables.at("Ch1").Field("values")->numbers.empty());
  const auto titled = ReadMat(Path("a.mat"), {"EMG"});
  ASSERT_TRUE(titled) << titled.error().message;
  EXPECT_EQ(titled->variables.at("Ch1").Field("values")->numbers, (std::vector<double>{1, 2}));
}

TEST_P(MatFileOf, SaysWhatItDoesNotRead) {
  MatWriter(Path("a.mat"), GetParam()).Complex("c").Sparse("s");
  const auto read = ReadMat(Path("a.mat"), {"c", "s"});
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->variables.at("c").other, "is complex, expected real numbers");
  EXPECT_THAT(read->variables.at("s").other, HasSubstr("is sparse, expected a full array"));
}

TEST_P(MatFileOf, ATruncatedFileIsAnErrorAtEveryLength) {
  MatWriter(Path("a.mat"), GetParam())
      .Column("x", std::vector<double>(300, 1.25))
      .Spike2("y", "y", "V", 1, 0, {1, 2});
  const std::string whole = Bytes(Path("a.mat"));
  ASSERT_TRUE(ReadMat(Path("a.mat"), {"x", "y"}));
  for (std::size_t length = 0; length < whole.size(); length += 1 + whole.size() / 60)
    EXPECT_NE(ErrorOf(Write("cut.mat", whole.substr(0, length)), {"x"}), "")
        << length << " of " << whole.size();
}

TEST_P(MatFileOf, DamagedBytesAreAnErrorOrOtherContentButNeverACrash) {
  constexpr int kFiles = 80;
  constexpr int kMaxBytes = 8;
  MatWriter(Path("a.mat"), GetParam())
      .Column("x", std::vector<double>(200, 0.5))
      .Spike2("y", "EMG", "V", 1e-3, 0, {1, 2, 3})
      .StructArray("Fdat", "Region", "FL", {{1, 2}, {3, 4}})
      .Cells("cells", {{1, 2, 3}, {4}});
  const std::string valid = Bytes(Path("a.mat"));
  Random random(3);
  int errors = 0;
  for (int i = 0; i < kFiles; ++i) {
    std::string bytes = valid;
    const std::uint64_t replaced = 1 + random.Index(kMaxBytes);
    for (std::uint64_t k = 0; k < replaced; ++k)
      bytes[random.Index(bytes.size())] = static_cast<char>(random.Index(256));
    const std::string error = ErrorOf(Write("b.mat", bytes), {"x", "y", "Fdat", "cells"});
    if (error.empty()) continue;
    ++errors;
    EXPECT_EQ(error.rfind(Path("b.mat") + ": ", 0), 0U) << error;
  }
  EXPECT_GT(errors, 0);
  EXPECT_TRUE(ReadMat(Path("a.mat"), {"x"})) << "libmatio must still work";
}

TEST_F(MatFolder, OtherFilesAreSaid) {
  EXPECT_THAT(ErrorOf(Path("none.mat")), HasSubstr("no such file"));
  EXPECT_THAT(ErrorOf(folder_.string()), HasSubstr("is a folder"));
  EXPECT_THAT(ErrorOf(Write("empty.mat", "")),
              HasSubstr("is empty, expected a MAT file of version 5 or 7.3"));
  EXPECT_THAT(ErrorOf(Write("text.mat", "time,force\n0,1\n")), HasSubstr("is not a MAT file"));
  EXPECT_THAT(ErrorOf(Write("long.mat", std::string(5000, 'a'))), HasSubstr("is not a MAT file"));
  EXPECT_THAT(ErrorOf(Write("zeros.mat", std::string(5000, '\0'))), HasSubstr("is not a MAT file"));
  EXPECT_THAT(ErrorOf(Write("hdf5.mat", "\x89HDF\r\n\x1a\n and more")),
              HasSubstr("is an HDF5 file without the header"));
  // A 2 x 1 array 'x' as version 4 stores it: MOPT 0, rows, columns, real, length of the name.
  const std::string version4 =
      std::string("\0\0\0\0\2\0\0\0\1\0\0\0\0\0\0\0\2\0\0\0x\0", 22) + std::string(16, '\0');
  EXPECT_THAT(ErrorOf(Write("v4.mat", version4)), HasSubstr("is a MAT file of version 4"));
  std::string unknown(128, ' ');
  unknown += "no content";
  unknown.replace(124, 4, std::string("\0\3IM", 4));
  EXPECT_THAT(ErrorOf(Write("v3.mat", unknown)), HasSubstr("unknown version 0x0300"));
}

TEST_F(MatFolder, ATableIsSaidToBeUnreadable) {
  const auto read = ReadMat(Write("t.mat", MatObject("t", "table")), {"t"});
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_THAT(read->variables.at("t").other, HasSubstr("is a 'table', an object that MATLAB alone can read"));
}

TEST_F(MatFolder, AChangedByteOfCompressedNumbersIsFound) {
  std::vector<double> values(2000);
  Random random(4);
  for (double& value : values) value = random.Normal();
  MatWriter(Path("a.mat"), MatLayout::k5Compressed).Column("x", values);
  std::string bytes = Bytes(Path("a.mat"));
  ASSERT_TRUE(ReadMat(Path("a.mat"), {"x"}));
  for (std::size_t at = bytes.size() / 4; at < bytes.size(); at += bytes.size() / 16) {
    std::string changed = bytes;
    changed[at] = static_cast<char>(changed[at] ^ 1);
    EXPECT_THAT(ErrorOf(Write("b.mat", changed)), HasSubstr("disagrees with its checksum or ends early"))
        << at;
  }
}

TEST_F(MatFolder, TwoVariablesOfOneNameAreKnown) {
  MatWriter(Path("a.mat"), MatLayout::k5).Column("x", {1}).Column("y", {3});
  const std::string bytes = Bytes(Path("a.mat"));
  const std::string renamed = [&] {
    std::string copy = bytes;
    copy[copy.rfind('y')] = 'x';
    return copy;
  }();
  const auto read = ReadMat(Write("b.mat", renamed), {"x"});
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->twice, (std::set<std::string>{"x"}));
  EXPECT_EQ(read->variables.at("x").numbers, (std::vector<double>{1}));
}

TEST_F(MatFolder, EnormousDimensionsAskForNoMemory) {
  MatWriter(Path("a.mat"), MatLayout::k5).Column("x", std::vector<double>(7, 1.5));
  std::string bytes = Bytes(Path("a.mat"));
  // The sizes 7 and 1, 32 bits each, after the tag of a miINT32 element of 8 bytes.
  const std::string sizes("\5\0\0\0\x8\0\0\0\7\0\0\0\1\0\0\0", 16);
  const auto at = bytes.find(sizes);
  ASSERT_NE(at, std::string::npos);
  for (const char* huge :
       {"\xff\xff\xff\x7f\1\0\0\0", "\xff\xff\xff\x7f\xff\xff\xff\x7f", "\0\0\0\x10\1\0\0\0"}) {
    bytes.replace(at + 8, 8, std::string(huge, 8));
    const auto read = ReadMat(Write("b.mat", bytes), {"x"});
    const std::string said = read ? read->variables.at("x").other : read.error().message;
    EXPECT_THAT(said, ::testing::AnyOf(HasSubstr("has more than 268435456 values"),
                                       HasSubstr("announces more values than the file can hold")));
    EXPECT_TRUE(ReadMat(Path("b.mat"), {})) << "it is not wanted";
  }
}

TEST_F(MatFolder, LinksToOtherFilesAreNotFollowed) {
  MatWriter(Path("secret.mat"), MatLayout::k73).Column("x", {1, 2});
  for (const bool linked : {false, true}) {
    MatWriter(Path("a.mat"), MatLayout::k73).Column("y", {1});
    const hid_t file = H5Fopen(Path("a.mat").c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
    ASSERT_GE(file, 0);
    if (linked) H5Lcreate_external("secret.mat", "/x", file, "x", H5P_DEFAULT, H5P_DEFAULT);
    if (!linked) H5Lcreate_soft("/y", file, "x", H5P_DEFAULT, H5P_DEFAULT);
    H5Fclose(file);
    const std::string error = ErrorOf(Path("a.mat"));
    EXPECT_THAT(error, linked ? HasSubstr("is a link to another file") : HasSubstr(""));
    EXPECT_EQ(error.empty(), !linked) << error;
  }
}

}  // namespace
}  // namespace sinew
