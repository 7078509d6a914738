#include "base/held_file.h"

#include <dirent.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <ctime>
#include <memory>
#include <mutex>
#include <set>
#include <string_view>
#include <utility>
#include <vector>

namespace sinew {
namespace {

constexpr std::string_view kStart = ".sinew-";
constexpr std::string_view kTemporaryEnd = ".tmp";
constexpr std::string_view kLockEnd = ".lock";
constexpr int kMostTries = 100;         // of a new name or a lock: each loses a race against a removal
constexpr std::time_t kForeign = 3600;  // [s] age of another machine's file

// Leaked on purpose: threads may still work when static objects are destroyed.
struct Held {
  std::mutex mutex;  // also held while a file is made, so that each that exists is among the paths
  std::set<std::string> paths;
};
Held& AllHeld() {
  static auto* const kHeld = new Held;
  return *kHeld;
}

std::uint64_t Fnv1a(std::string_view text) {
  std::uint64_t hash = 14695981039346656037U;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211U;
  return hash;
}

std::uint32_t Machine() {
  std::array<char, 256> name{};
  gethostname(name.data(), name.size() - 1);
  return static_cast<std::uint32_t>(Fnv1a(name.data()));
}

std::uint32_t RandomNumber() {
  std::uint32_t number = 0;
  if (getrandom(&number, sizeof number, GRND_NONBLOCK) == sizeof number) return number;
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return static_cast<std::uint32_t>(now.tv_nsec);
}

// Whether the open file is what its name leads to: it may have been removed before the lock was ours.
bool IsThere(int descriptor, const std::string& path) {
  struct stat open_file {};
  struct stat named {};
  return fstat(descriptor, &open_file) == 0 && lstat(path.c_str(), &named) == 0 &&
         open_file.st_dev == named.st_dev && open_file.st_ino == named.st_ino;
}

// @return 0, EWOULDBLOCK, or ENOTSUP
int Lock(int descriptor) {
  while (flock(descriptor, LOCK_EX | LOCK_NB) != 0) {
    if (errno == EWOULDBLOCK) return EWOULDBLOCK;
    if (errno != EINTR) return ENOTSUP;
  }
  return 0;
}

bool EndsWith(std::string_view text, std::string_view end) {
  return text.size() >= end.size() && text.substr(text.size() - end.size()) == end;
}

void RemoveIfAbandoned(const std::string& folder, const std::string& name) {
  const std::string path = folder + "/" + name;
  const int file = open(path.c_str(), O_RDWR | O_NONBLOCK | O_NOFOLLOW | O_CLOEXEC);
  if (file < 0) return;
  struct stat status {};
  const bool is_file = fstat(file, &status) == 0 && S_ISREG(status.st_mode);
  const bool ours = EndsWith(name, kLockEnd) || name.find(fmt::format("-{:08x}-", Machine())) != name.npos;
  const bool old = std::time(nullptr) - status.st_mtime > kForeign;
  if (is_file && (ours || old) && Lock(file) == 0 && IsThere(file, path)) unlink(path.c_str());
  close(file);
}

}  // namespace

HeldFile::HeldFile(std::string path, int descriptor) : path_(std::move(path)), descriptor_(descriptor) {
  const std::lock_guard lock(AllHeld().mutex);
  AllHeld().paths.insert(path_);
}

HeldFile::~HeldFile() {
  Drop();
}

HeldFile::HeldFile(HeldFile&& other) noexcept
    : path_(std::move(other.path_)), descriptor_(std::exchange(other.descriptor_, -1)) {}

HeldFile& HeldFile::operator=(HeldFile&& other) noexcept {
  if (this != &other) {
    Drop();
    path_ = std::move(other.path_);
    descriptor_ = std::exchange(other.descriptor_, -1);
  }
  return *this;
}

void HeldFile::Keep() {
  if (descriptor_ < 0) return;
  {
    const std::lock_guard lock(AllHeld().mutex);
    AllHeld().paths.erase(path_);
  }
  close(std::exchange(descriptor_, -1));
}

void HeldFile::Drop() {
  if (descriptor_ < 0) return;
  // Removed while the lock is held: afterwards the name may be another process's.
  unlink(path_.c_str());
  Keep();
}

int MakeTemporaryFile(const std::string& folder, HeldFile& file) {
  for (int i = 0; i < kMostTries; ++i) {
    const std::string path = fmt::format("{}/{}{:08x}-{}-{:08x}{}", folder, kStart, Machine(), getpid(),
                                         RandomNumber(), kTemporaryEnd);
    std::unique_lock making(AllHeld().mutex);
    const int descriptor = open(path.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor < 0 && errno == EEXIST) continue;
    if (descriptor < 0) return errno;
    // Somebody who removes abandoned files may have come in between.
    const int locked = Lock(descriptor);
    if (locked != EWOULDBLOCK && (locked == ENOTSUP || IsThere(descriptor, path))) {
      AllHeld().paths.insert(path);
      making.unlock();
      file = HeldFile(path, descriptor);
      return 0;
    }
    close(descriptor);
  }
  return EEXIST;
}

int HoldFile(const std::string& path, HeldFile& file) {
  for (int i = 0; i < kMostTries; ++i) {
    std::unique_lock making(AllHeld().mutex);
    const int descriptor = open(path.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0666);
    if (descriptor < 0) return errno;
    const int locked = Lock(descriptor);
    if (locked == 0 && IsThere(descriptor, path)) {
      AllHeld().paths.insert(path);
      making.unlock();
      file = HeldFile(path, descriptor);
      return 0;
    }
    if (locked == ENOTSUP) unlink(path.c_str());
    close(descriptor);
    if (locked != 0) return locked;
  }
  return EWOULDBLOCK;
}

std::string LockNameOf(const std::string& file_name) {
  return fmt::format("{}{:016x}{}", kStart, Fnv1a(file_name), kLockEnd);
}

void RemoveAbandonedFiles(const std::string& folder) {
  static std::mutex mutex;
  static std::set<std::string> done;
  {
    const std::lock_guard lock(mutex);
    if (!done.insert(folder).second) return;
  }
  const std::unique_ptr<DIR, int (*)(DIR*)> entries(opendir(folder.c_str()), closedir);
  if (!entries) return;
  std::vector<std::string> names;
  while (const dirent* entry = readdir(entries.get())) {
    const std::string_view name = entry->d_name;
    if (name.substr(0, kStart.size()) == kStart &&
        (EndsWith(name, kTemporaryEnd) || EndsWith(name, kLockEnd)))
      names.emplace_back(name);
  }
  for (const std::string& name : names) RemoveIfAbandoned(folder, name);
}

void RemoveHeldFiles() {
  Held& held = AllHeld();
  // Stays locked: no other thread shall make a file between here and the end of the process.
  held.mutex.lock();
  for (const std::string& path : held.paths) unlink(path.c_str());
}

}  // namespace sinew
