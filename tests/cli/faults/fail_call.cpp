// Preloaded into a program (LD_PRELOAD), makes its nth call of one function of the file system fail: a full
// disk, a spent quota, a broken or a read-only one, at every place where one can be met.
//
// Environment: SINEW_FAULT_CALL (open, write, fsync or rename), SINEW_FAULT_AT (the first call that fails,
// from 1), SINEW_FAULT_LAST (the last one), SINEW_FAULT_ERRNO, SINEW_FAULT_FOLDER (only files whose path
// holds this text count, and opening only where it is for writing), SINEW_FAULT_MARK (a file that is made
// when a call has failed).
#include <dlfcn.h>
#include <fcntl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace {

const char* Setting(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? "" : value;
}

// Whether this call is one that is to fail; errno is then set.
bool Fails(const char* call, const char* path) {
  static std::atomic<long> count{0};
  if (std::strcmp(Setting("SINEW_FAULT_CALL"), call) != 0) return false;
  if (std::strstr(path, Setting("SINEW_FAULT_FOLDER")) == nullptr) return false;
  const long now = ++count;
  if (now < std::atol(Setting("SINEW_FAULT_AT")) || now > std::atol(Setting("SINEW_FAULT_LAST")))
    return false;
  const long mark = syscall(SYS_openat, AT_FDCWD, Setting("SINEW_FAULT_MARK"), O_WRONLY | O_CREAT, 0666);
  if (mark >= 0) syscall(SYS_close, mark);
  errno = std::atoi(Setting("SINEW_FAULT_ERRNO"));
  return true;
}

bool FailsOn(const char* call, int file) {
  char link[64];
  char path[4096];
  std::snprintf(link, sizeof link, "/proc/self/fd/%d", file);
  const ssize_t length = readlink(link, path, sizeof path - 1);
  if (length < 0) return false;
  path[length] = '\0';
  return Fails(call, path);
}

template <class Function>
Function Next(const char* name) {
  return reinterpret_cast<Function>(dlsym(RTLD_NEXT, name));
}

int Open(const char* name, const char* path, int flags, mode_t mode) {
  const bool writes = (flags & O_ACCMODE) != O_RDONLY;
  char resolved[4096];
  const char* place = path[0] == '/' ? path : getcwd(resolved, sizeof resolved);
  if (writes && place != nullptr && Fails("open", place)) return -1;
  return Next<int (*)(const char*, int, ...)>(name)(path, flags, mode);
}

}  // namespace

extern "C" {

int open(const char* path, int flags, ...) {
  va_list rest;
  va_start(rest, flags);
  const mode_t mode = (flags & (O_CREAT | O_TMPFILE)) != 0 ? va_arg(rest, mode_t) : 0;
  va_end(rest);
  return Open("open", path, flags, mode);
}

int open64(const char* path, int flags, ...) {
  va_list rest;
  va_start(rest, flags);
  const mode_t mode = (flags & (O_CREAT | O_TMPFILE)) != 0 ? va_arg(rest, mode_t) : 0;
  va_end(rest);
  return Open("open64", path, flags, mode);
}

ssize_t write(int file, const void* bytes, size_t count) {
  if (FailsOn("write", file)) return -1;
  return Next<ssize_t (*)(int, const void*, size_t)>("write")(file, bytes, count);
}

int fsync(int file) {
  if (FailsOn("fsync", file)) return -1;
  return Next<int (*)(int)>("fsync")(file);
}

int rename(const char* from, const char* to) {
  char folder[4096];
  const char* place = to[0] == '/' ? to : getcwd(folder, sizeof folder);
  if (place != nullptr && Fails("rename", place)) return -1;
  return Next<int (*)(const char*, const char*)>("rename")(from, to);
}

}  // extern "C"
