#include "base/file_lock.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include "base/replace_file.h"

namespace sinew {
namespace {

namespace fs = std::filesystem;

class FileLocks : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("sinew_lock_" + std::to_string(::getpid()) +
                                           ::testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::create_directory(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  std::string Path(const std::string& name) { return (folder_ / name).string(); }
  std::vector<std::string> Names() {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder_))
      names.push_back(entry.path().filename().string());
    return names;
  }

  fs::path folder_;
};

TEST_F(FileLocks, AreHeldOnceAndLeaveNothing) {
  {
    const auto first = FileLock::Try(Path("a"));
    ASSERT_TRUE(first && first->held());
    const auto second = FileLock::Try(Path("a"));
    ASSERT_TRUE(second);
    EXPECT_FALSE(second->held());
    EXPECT_EQ(second->holder().rfind("process " + std::to_string(getpid()) + " on ", 0), 0);
    EXPECT_TRUE(FileLock::Try(Path("b"))->held());
  }
  EXPECT_TRUE(Names().empty());
  EXPECT_TRUE(FileLock::Try(Path("a"))->held());
}

TEST_F(FileLocks, HoldWhileTheFileIsReplaced) {
  const auto lock = FileLock::Try(Path("a"));
  ASSERT_TRUE(ReplaceFile(Path("a"), "x"));
  EXPECT_FALSE(FileLock::Try(Path("a"))->held());
}

TEST_F(FileLocks, AreOfTheFileThatALinkLeadsTo) {
  fs::create_symlink("a", folder_ / "link");
  const auto lock = FileLock::Try(Path("link"));
  EXPECT_FALSE(FileLock::Try(Path("a"))->held());
}

TEST_F(FileLocks, NeedAFolder) {
  EXPECT_THAT(FileLock::Try(Path("no/a")).error().message, ::testing::HasSubstr("No such file or directory"));
}

TEST_F(FileLocks, EndWithTheirProcess) {
  int ready[2];
  ASSERT_EQ(pipe(ready), 0);
  const pid_t child = fork();
  if (child == 0) {
    const auto lock = FileLock::Try(Path("a"));
    HeldFile file;
    const bool made = lock && lock->held() && MakeTemporaryFile(folder_.string(), file) == 0;
    static_cast<void>(!write(ready[1], made ? "y" : "n", 1));
    pause();
  }
  char answer = 'n';
  ASSERT_EQ(read(ready[0], &answer, 1), 1);
  ASSERT_EQ(answer, 'y');
  EXPECT_FALSE(FileLock::Try(Path("a"))->held());
  EXPECT_EQ(Names().size(), 2);
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  {
    const auto lock = FileLock::Try(Path("a"));
    EXPECT_TRUE(lock->held());
  }
  close(ready[0]);
  close(ready[1]);
}

// In a process of its own: a folder is looked through once per process.
void WriteInAnotherProcess(const std::string& path) {
  const pid_t child = fork();
  if (child == 0) _exit(ReplaceFile(path, "x") ? 0 : 1);
  int status = -1;
  waitpid(child, &status, 0);
  ASSERT_EQ(status, 0);
}

TEST_F(FileLocks, WhatIsAbandonedIsRemovedByTheNextThatWrites) {
  HeldFile alive;
  ASSERT_EQ(MakeTemporaryFile(folder_.string(), alive), 0);
  const std::string kept = fs::path(alive.path()).filename().string();
  const std::string machine = kept.substr(0, kept.find('-', 7) + 1);  // ".sinew-MACHINE-"
  const std::string foreign = ".sinew-00000000-1-00000000.tmp";
  const std::string old = ".sinew-00000000-2-00000000.tmp";
  for (const std::string& name :
       {machine + "1-00000000.tmp", LockNameOf("x"), foreign, old, std::string("a.tmp")})
    std::ofstream(Path(name)) << "x";
  fs::last_write_time(Path(old), fs::file_time_type::clock::now() - std::chrono::hours(2));
  WriteInAnotherProcess(Path("a"));
  EXPECT_THAT(Names(), ::testing::UnorderedElementsAre("a", "a.tmp", kept, foreign));
}

TEST_F(FileLocks, NoneIsMadeAfterAllHaveBeenRemoved) {
  for (int i = 0; i < 5; ++i) {
    const pid_t child = fork();
    ASSERT_GE(child, 0);
    if (child == 0) {  // ends without destructors while another thread works on
      std::thread([this] {
        while (true) {
          HeldFile lock;
          HeldFile temporary;
          static_cast<void>(HoldFile(Path(LockNameOf("a")), lock));
          static_cast<void>(MakeTemporaryFile(folder_.string(), temporary));
        }
      }).detach();
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
      RemoveHeldFiles();
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
      _exit(0);
    }
    int status = 0;
    ASSERT_EQ(waitpid(child, &status, 0), child);
    EXPECT_EQ(status, 0);
    EXPECT_THAT(Names(), ::testing::IsEmpty());
  }
}

TEST_F(FileLocks, TemporaryNamesAreShort) {
  HeldFile file;
  ASSERT_EQ(MakeTemporaryFile(folder_.string(), file), 0);
  EXPECT_LE(fs::path(file.path()).filename().string().size(), 41);
  EXPECT_EQ(LockNameOf(std::string(255, 'a')).size(), 28);
}

}  // namespace
}  // namespace sinew
