#include "cli/cohort/children.h"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>

#include "cli/mpi_ranks.h"

namespace sinew::cohort {
namespace {

constexpr int kNotStarted = 127;

// In the new process, where other threads of the old one may have held locks: system calls only.
[[noreturn]] void Become(char* const* words, char* const* environment, const char* folder, int log,
                         pid_t parent) {
  // A group of its own: Ctrl-C reaches it once, from its parent, and a second one would end it unsaved.
  setpgid(0, 0);
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (getppid() != parent) _exit(kNotStarted);  // it died before it could be asked
  const int nothing = open("/dev/null", O_RDONLY);
  if (nothing < 0 || dup2(nothing, STDIN_FILENO) < 0 || dup2(log, STDOUT_FILENO) < 0 ||
      dup2(log, STDERR_FILENO) < 0 || chdir(folder) != 0)
    _exit(kNotStarted);
  execve("/proc/self/exe", words, environment);
  _exit(kNotStarted);
}

}  // namespace

Result<int> Children::Run(const std::vector<std::string>& words, const std::string& folder,
                          const std::string& log) {
  const int file = open(log.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
  if (file < 0) return Fail("{}: {}", log, std::strerror(errno));
  std::vector<std::string> all{"sinew"};
  all.insert(all.end(), words.begin(), words.end());
  std::vector<char*> arguments;
  for (std::string& word : all) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  std::vector<std::string> variables = EnvironmentOfOneProcess();
  std::vector<char*> environment;
  for (std::string& variable : variables) environment.push_back(variable.data());
  environment.push_back(nullptr);
  const pid_t parent = getpid();
  pid_t child = -1;
  {
    const std::lock_guard lock(mutex_);
    if (stopped_by_ != 0) {
      close(file);
      return 128 + stopped_by_;
    }
    child = fork();
    if (child == 0) Become(arguments.data(), environment.data(), folder.c_str(), file, parent);
    if (child > 0) running_.insert(child);
  }
  close(file);
  if (child < 0) return Fail("cannot start another process: {}", std::strerror(errno));
  // Seen, but not yet taken off the table of processes: its number is nobody else's while a signal may be
  // sent.
  siginfo_t ended{};
  while (waitid(P_PID, static_cast<id_t>(child), &ended, WEXITED | WNOWAIT) < 0 && errno == EINTR) {
  }
  int status = 0;
  {
    const std::lock_guard lock(mutex_);
    running_.erase(child);
    while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
  }
  if (WIFEXITED(status) && WEXITSTATUS(status) == kNotStarted)
    return Fail("the command could not be started in {}", folder);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

void Children::Stop(int signal) {
  const std::lock_guard lock(mutex_);
  stopped_by_ = signal;
  for (const pid_t child : running_) kill(child, signal);
}

bool Children::stopped() const {
  const std::lock_guard lock(mutex_);
  return stopped_by_ != 0;
}

}  // namespace sinew::cohort
