#include "base/hdf5_tree.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "base/random.h"

namespace sinew {
namespace {

using ::testing::HasSubstr;

class Hdf5Tree : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() /
              ("sinew_hdf5_" + std::to_string(::getpid()) +
               ::testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::create_directory(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  std::string Path(const std::string& name) { return (folder_ / name).string(); }

  static Hdf5Node Example() {
    Hdf5Node root;
    root.attributes["schema"] = std::string("dataset/1");
    root.attributes["synthetic"] = std::int64_t{1};
    root.attributes["sigma"] = 0.25;
    root.At("trials/walk/time").SetVector({0, 0.5, 1});
    std::vector<double> many(5000);
    for (std::size_t i = 0; i < many.size(); ++i) many[i] = 0.1 * static_cast<double>(i);
    root.At("trials/walk/poses").SetMatrix(1000, 5, many);
    root.At("trials/walk/poses").attributes["unit"] = std::string("m");
    root.At("files/model").data = std::string("<xml>\n</xml>");
    root.At("names").data = std::vector<std::string>{"k", "", "mu_s"};
    root.At("mass").SetScalar(5.8);
    root.At("empty").SetVector({});
    root.At("group_without_members");
    return root;
  }

  std::filesystem::path folder_;
};

TEST_F(Hdf5Tree, ReadsWhatItWrote) {
  const Hdf5Node written = Example();
  ASSERT_TRUE(WriteHdf5(Path("a.h5"), written));
  const auto read = ReadHdf5(Path("a.h5"));
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->attributes, written.attributes);
  EXPECT_EQ(read->Find("trials/walk/poses")->array()->values,
            written.Find("trials/walk/poses")->array()->values);
  EXPECT_EQ(read->Find("trials/walk/poses")->array()->shape, (std::vector<std::size_t>{1000, 5}));
  EXPECT_EQ(read->Find("trials/walk/poses")->Text("unit"), "m");
  EXPECT_EQ(*read->Find("files/model")->text(), "<xml>\n</xml>");
  EXPECT_EQ(*read->Find("names")->texts(), (std::vector<std::string>{"k", "", "mu_s"}));
  EXPECT_TRUE(read->Find("mass")->array()->shape.empty());
  EXPECT_TRUE(read->Find("empty")->array()->values.empty());
  EXPECT_NE(read->Find("group_without_members"), nullptr);
  EXPECT_EQ(read->Find("trials/run"), nullptr);
  EXPECT_EQ(read->Number("synthetic", 0), 1);
}

TEST_F(Hdf5Tree, ReportsWhatIsWrongWithAFile) {
  EXPECT_THAT(ReadHdf5(Path("none.h5")).error().message, HasSubstr("no such file"));
  std::ofstream(Path("text.h5")) << "time,force\n";
  EXPECT_THAT(ReadHdf5(Path("text.h5")).error().message, HasSubstr("is not an HDF5 file"));
  EXPECT_THAT(ReadHdf5(folder_.string()).error().message, HasSubstr("is a folder"));
  ASSERT_EQ(mkfifo(Path("pipe.h5").c_str(), 0600), 0);
  for (const std::string& path : {std::string("/dev/null"), Path("pipe.h5")})
    EXPECT_THAT(ReadHdf5(path).error().message, HasSubstr("expected an HDF5 file"))
        << "a pipe has no reader, and would block";
}

TEST_F(Hdf5Tree, ATruncatedFileIsAnErrorAtEveryLength) {
  ASSERT_TRUE(WriteHdf5(Path("a.h5"), Example()));
  const auto size = std::filesystem::file_size(Path("a.h5"));
  for (std::uintmax_t length = 0; length < size; length += 97) {
    std::filesystem::copy_file(Path("a.h5"), Path("cut.h5"),
                               std::filesystem::copy_options::overwrite_existing);
    std::filesystem::resize_file(Path("cut.h5"), length);
    EXPECT_FALSE(ReadHdf5(Path("cut.h5"))) << length;
  }
}

TEST_F(Hdf5Tree, DamagedBytesAreAnErrorOrOtherContentButNeverACrash) {
  constexpr int kFiles = 300;
  constexpr int kMaxBytes = 16;
  ASSERT_TRUE(WriteHdf5(Path("a.h5"), Example()));
  std::ifstream whole(Path("a.h5"), std::ios::binary);
  const std::string valid{std::istreambuf_iterator<char>(whole), {}};
  Random random(1);
  int errors = 0;
  for (int i = 0; i < kFiles; ++i) {
    std::string bytes = valid;
    const std::uint64_t replaced = 1 + random.Index(kMaxBytes);
    for (std::uint64_t k = 0; k < replaced; ++k) {
      bytes[random.Index(bytes.size())] = static_cast<char>(random.Index(256));
    }
    std::ofstream(Path("b.h5"), std::ios::binary) << bytes;
    const auto read = ReadHdf5(Path("b.h5"));
    if (read) continue;
    ++errors;
    EXPECT_EQ(read.error().message.rfind(Path("b.h5") + ": ", 0), 0U) << read.error().message;
  }
  EXPECT_GT(errors, 0);
  EXPECT_LT(errors, kFiles);
  EXPECT_TRUE(ReadHdf5(Path("a.h5"))) << "libhdf5 must still work";
}

TEST_F(Hdf5Tree, AFailedWriteLeavesTheOldFileAndNothingElse) {
  EXPECT_THAT(WriteHdf5(Path("no/such/folder.h5"), Example()).error().message,
              HasSubstr("cannot be written"));
  ASSERT_TRUE(WriteHdf5(Path("a.h5"), Example()));
  ASSERT_TRUE(WriteHdf5(Path("a.h5"), Hdf5Node{}));  // replaced whole
  EXPECT_TRUE(ReadHdf5(Path("a.h5"))->children.empty());
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_), {}), 1);
}

TEST_F(Hdf5Tree, WhatHdf5WouldCutOffIsNotWritten) {
  using std::string_literals::operator""s;
  Hdf5Node text;
  text.children["notes"].data = "a\0b"s;
  Hdf5Node texts;
  texts.children["notes"].data = std::vector<std::string>{"a", "a\0b"s};
  Hdf5Node attribute;
  attribute.attributes["unit"] = "a\0b"s;
  Hdf5Node named;
  named.attributes["a\0b"s] = 1.0;
  Hdf5Node child;
  child.At("trials").children["a\0b"s].SetScalar(1);
  for (const Hdf5Node& root : {text, texts, attribute, named, child}) {
    const Status status = WriteHdf5(Path("a.h5"), root);
    ASSERT_FALSE(status);
    EXPECT_THAT(status.error().message, HasSubstr("a\\x00b' contains a null byte"));
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder_));
}

TEST_F(Hdf5Tree, TheSameTreeGivesTheSameBytes) {
  ASSERT_TRUE(WriteHdf5(Path("a.h5"), Example()));
  ASSERT_TRUE(WriteHdf5(Path("b.h5"), Example()));
  const auto bytes = [&](const std::string& name) {
    std::ifstream file(Path(name), std::ios::binary);
    return std::string{std::istreambuf_iterator<char>(file), {}};
  };
  EXPECT_EQ(bytes("a.h5"), bytes("b.h5"));
}

}  // namespace
}  // namespace sinew
