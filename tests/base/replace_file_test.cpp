#include "base/replace_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

namespace sinew {
namespace {

using ::testing::HasSubstr;
namespace fs = std::filesystem;

std::string Contents(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

class ReplacedFile : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("sinew_replace_" + std::to_string(::getpid()) +
                                           ::testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::create_directory(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  std::string Path(const std::string& name) { return (folder_ / name).string(); }
  [[nodiscard]] auto Files() const { return std::distance(fs::directory_iterator(folder_), {}); }

  fs::path folder_;
};

// While it lives, no file of this process becomes larger.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) {
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limited{bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limited);
  }
  ~FileSizeLimit() { setrlimit(RLIMIT_FSIZE, &before_); }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;

 private:
  rlimit before_{};
};

TEST_F(ReplacedFile, HoldsTheBytes) {
  const std::string bytes("a\0b\n", 4);
  ASSERT_TRUE(ReplaceFile(Path("a"), bytes));
  EXPECT_EQ(Contents(Path("a")), bytes);
  ASSERT_TRUE(ReplaceFile(Path("a"), ""));
  EXPECT_EQ(Contents(Path("a")), "");
  EXPECT_EQ(Files(), 1);
}

TEST_F(ReplacedFile, IsUnchangedByAFullDiskAndItsSignalDoesNotEndTheProcess) {
  ASSERT_TRUE(ReplaceFile(Path("a"), "old"));
  for (const auto disposition : {SIG_DFL, SIG_IGN}) {
    std::signal(SIGXFSZ, disposition);
    const FileSizeLimit limit(1000);
    EXPECT_THAT(ReplaceFile(Path("a"), std::string(2000, 'x')).error().message,
                HasSubstr("a: cannot be written: File too large"));
    EXPECT_TRUE(ReplaceFile(Path("b"), std::string(1000, 'x'))) << "as much as there is room for";
  }
  std::signal(SIGXFSZ, SIG_DFL);
  sigset_t waiting;
  sigpending(&waiting);
  EXPECT_EQ(sigismember(&waiting, SIGXFSZ), 0);
  EXPECT_EQ(Contents(Path("a")), "old");
  EXPECT_EQ(Files(), 2);
}

TEST_F(ReplacedFile, IsTheTargetOfALink) {
  ASSERT_TRUE(ReplaceFile(Path("a"), "old"));
  fs::create_symlink("a", folder_ / "link");
  ASSERT_TRUE(ReplaceFile(Path("link"), "new"));
  EXPECT_EQ(Contents(Path("a")), "new");
  EXPECT_TRUE(fs::is_symlink(folder_ / "link"));
}

TEST_F(ReplacedFile, IsTheTargetOfALinkThatLeadsNowhereYet) {
  fs::create_directory(folder_ / "elsewhere");
  fs::create_symlink("elsewhere/a", folder_ / "link");
  ASSERT_TRUE(ReplaceFile(Path("link"), "new"));
  EXPECT_EQ(Contents(Path("elsewhere/a")), "new");
  EXPECT_TRUE(fs::is_symlink(folder_ / "link"));
  fs::create_symlink("circle", folder_ / "circle");
  EXPECT_THAT(ReplaceFile(Path("circle"), "new").error().message, HasSubstr("lead in a circle"));
}

TEST_F(ReplacedFile, KeepsPermissions) {
  ASSERT_TRUE(ReplaceFile(Path("a"), "old"));
  ASSERT_EQ(chmod(Path("a").c_str(), 0640), 0);
  ASSERT_TRUE(ReplaceFile(Path("a"), "new"));
  EXPECT_EQ(fs::status(Path("a")).permissions(), static_cast<fs::perms>(0640));
}

TEST_F(ReplacedFile, MayHaveTheLongestName) {
  const std::string name(255, 'a');
  ASSERT_TRUE(ReplaceFile(Path(name), "new"));
  EXPECT_EQ(Contents(Path(name)), "new");
  EXPECT_THAT(CheckReplaceable(Path(name + "a")).error().message, HasSubstr("expected at most 255 bytes"));
  std::string path = folder_.string();
  while (path.size() < 4096) path += "/.";
  EXPECT_THAT(CheckReplaceable(path + "/a").error().message, HasSubstr("its path is too long"));
}

TEST_F(ReplacedFile, IsNoFolderDeviceOrPipe) {
  EXPECT_THAT(ReplaceFile(folder_.string(), "x").error().message, HasSubstr("is a folder"));
  ASSERT_EQ(mkfifo(Path("pipe").c_str(), 0600), 0);
  for (const std::string& path : {std::string("/dev/null"), Path("pipe")}) {
    EXPECT_THAT(ReplaceFile(path, "x").error().message, HasSubstr("expected a regular file"));
    EXPECT_FALSE(CheckReplaceable(path));
  }
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
  EXPECT_TRUE(fs::is_fifo(folder_ / "pipe"));
  EXPECT_TRUE(CheckReplaceable(Path("not there yet")));
}

TEST_F(ReplacedFile, NeedsAFolder) {
  EXPECT_THAT(ReplaceFile(Path("no/a"), "x").error().message, HasSubstr("there is no folder"));
  EXPECT_EQ(Files(), 0);
}

}  // namespace
}  // namespace sinew
