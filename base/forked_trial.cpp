#include "base/forked_trial.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <filesystem>

namespace sinew {
namespace {

// Time limit of a reading [s], with one more second for every kBytesPerSecond of the file. An intact file of
// a megabyte is read in 0.01 s, by libmatio one of many small arrays in a second; a busy machine takes
// longer.
constexpr rlim_t kProcessorSeconds = 10;
constexpr unsigned kSeconds = 30;  // with waiting for a disk and for other processes
constexpr std::uintmax_t kBytesPerSecond = 1U << 20;
constexpr std::size_t kPiece = std::size_t{1} << 16U;  // [bytes] taken from the pipe at once
// How the process ends. Libraries, and sanitizers, end one with 1.
constexpr int kRead = 0;
constexpr int kFailed = 101;
constexpr int kLost = 102;

void LimitTime(const std::string& path) {
  for (const int signal : {SIGALRM, SIGXCPU, SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT})
    std::signal(signal, SIG_DFL);
  sigset_t time_up;
  sigemptyset(&time_up);
  sigaddset(&time_up, SIGALRM);
  sigprocmask(SIG_UNBLOCK, &time_up, nullptr);
  std::error_code code;
  const std::uintmax_t more = std::filesystem::file_size(path, code) / kBytesPerSecond;
  alarm(kSeconds + static_cast<unsigned>(more));
  const rlimit processor{kProcessorSeconds + more, kProcessorSeconds + more};
  setrlimit(RLIMIT_CPU, &processor);
  const rlimit no_core{0, 0};
  setrlimit(RLIMIT_CORE, &no_core);
}

// What this process has already counts, and is more than it seems where a sanitizer works.
void LimitMemory(std::size_t more) {
  std::FILE* sizes = std::fopen("/proc/self/statm", "r");
  if (sizes == nullptr) return;
  unsigned long pages = 0;
  const int count = std::fscanf(sizes, "%lu", &pages);
  std::fclose(sizes);
  if (count != 1) return;
  const rlim_t most = static_cast<rlim_t>(pages) * static_cast<rlim_t>(sysconf(_SC_PAGESIZE)) + more;
  const rlimit memory{most, most};
  setrlimit(RLIMIT_AS, &memory);
}

// Closes all other files: a lock that this process inherited would outlive its parent, should that be killed.
int KeepOnly(int file) {
  constexpr int kKept = STDERR_FILENO + 1;
  if (file != kKept) file = dup2(file, kKept);
  close_range(kKept + 1, ~0U, 0);
  return file;
}

bool WriteAll(int file, const std::string& bytes) {
  std::size_t written = 0;
  while (written < bytes.size()) {
    const ssize_t count = write(file, bytes.data() + written, bytes.size() - written);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return false;
    written += static_cast<std::size_t>(count);
  }
  return true;
}

// The work of the forked process, of which nothing but its result may reach its parent. noexcept: an
// exception, such as too little memory, ends it like a crash. It ends by _exit, without the destructors and
// buffers of its parent.
[[noreturn]] void WorkAndExit(const std::string& path, std::size_t memory, int result,
                              const std::function<Result<std::string>()>& work) noexcept {
  result = KeepOnly(result);
  LimitTime(path);
  if (memory != 0) LimitMemory(memory);
  const int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);
  if (nowhere >= 0) {
    dup2(nowhere, STDOUT_FILENO);
    dup2(nowhere, STDERR_FILENO);
  }
  const Result<std::string> done = work();
  const bool told = WriteAll(result, done ? *done : done.error().message);
  _exit(!told ? kLost : done ? kRead : kFailed);
}

std::string ReadAll(int file) {
  std::string text;
  std::size_t length = 0;
  while (true) {
    text.resize(length + kPiece);
    const ssize_t count = read(file, text.data() + length, kPiece);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) break;
    length += static_cast<std::size_t>(count);
  }
  text.resize(length);
  return text;
}

}  // namespace

std::mutex& Hdf5Mutex() {
  static std::mutex mutex;
  return mutex;
}

Result<std::string> TryInOwnProcess(const std::string& path, const std::string& library, std::size_t memory,
                                    const std::function<Result<std::string>()>& work) {
#ifdef SINEW_READ_IN_THIS_PROCESS  // fuzzers of tests/fuzz: what a process of its own would hide is to be
                                   // seen
  static_cast<void>(memory);
  static_cast<void>(library);
  static_cast<void>(path);
  return work();
#endif
  int ends[2] = {-1, -1};
  if (pipe2(ends, O_CLOEXEC) != 0) return Fail("{}: cannot be checked: too many files are open", path);
  const pid_t child = fork();
  if (child == 0) WorkAndExit(path, memory, ends[1], work);
  close(ends[1]);
  std::string result = child > 0 ? ReadAll(ends[0]) : std::string();
  close(ends[0]);
  if (child < 0) return Fail("{}: cannot be checked: no further process can be started", path);
  int status = 0;
  pid_t ended = -1;
  do {
    ended = waitpid(child, &status, 0);
  } while (ended < 0 && errno == EINTR);
  if (ended != child) return Fail("{}: cannot be checked: the process that reads it was lost", path);
  if (WIFEXITED(status) && WEXITSTATUS(status) == kRead) return result;
  if (WIFEXITED(status) && WEXITSTATUS(status) == kFailed) return Fail("{}", result);
  return Fail("{}: is damaged ({} could not read it)", path, library);
}

}  // namespace sinew
