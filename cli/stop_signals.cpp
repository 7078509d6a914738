#include "cli/stop_signals.h"

#include <poll.h>
#include <pthread.h>
#include <sys/eventfd.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <mutex>
#include <thread>
#include <utility>

#include "base/held_file.h"
#include "base/printable.h"

namespace sinew {
namespace {

// Of the second that a command has: for ending in order, with the rest for writing what there is.
constexpr std::chrono::milliseconds kGrace{600};
// One request may arrive twice: from a batch system and from `timeout` or a shell between it and the program.
constexpr std::chrono::milliseconds kSameRequest{300};

std::atomic<bool> interrupted{false};
std::atomic<int> stop_signal{0};
std::atomic<bool> others_end{false};
constexpr int kOwnReason = -1;  // stop_signal of StopFor
constexpr int kStatusOfOwnReason = 1;

// Of StopFor; set before stop_signal, and not again.
std::mutex reason_mutex;
std::string own_reason;

// Who may do what at the end. A work is registered, finished, or taken over by the listening thread.
struct Works {
  std::mutex mutex;
  StoppableWork::Save save;
  std::function<void(int)> on_signal;
  bool registered = false;
  bool finished = false;
};
Works& TheWorks() {
  static auto* const kWorks = new Works;  // leaked: the process may end while a thread still looks at it
  return *kWorks;
}

class Listener {
 public:
  explicit Listener(std::string name)
      : name_(std::move(name)), end_(eventfd(0, EFD_CLOEXEC)), request_(eventfd(0, EFD_CLOEXEC)) {
    sigemptyset(&signals_);
    for (const int signal : {SIGINT, SIGTERM}) {
      struct sigaction now {};
      if (sigaction(signal, nullptr, &now) == 0 && now.sa_handler != SIG_IGN) sigaddset(&signals_, signal);
    }
    pthread_sigmask(SIG_BLOCK, &signals_, &before_);
    arrivals_ = signalfd(-1, &signals_, SFD_CLOEXEC);
    thread_ = std::thread([this] { Listen(); });
  }
  ~Listener() {
    Raise(end_);
    thread_.join();
    close(arrivals_);
    close(end_);
    close(request_);
    pthread_sigmask(SIG_SETMASK, &before_, nullptr);
  }
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;

  /// The program asks itself to stop.
  void Request() { Raise(request_); }

 private:
  static void Raise(int event) {
    const std::uint64_t one = 1;
    static_cast<void>(!write(event, &one, sizeof one));
  }

  // The signal that has come, or kOwnReason, or 0: the program has ended, or nothing came in that time.
  int Wait(int milliseconds) {
    std::array<pollfd, 3> files{pollfd{arrivals_, POLLIN, 0}, pollfd{end_, POLLIN, 0},
                                pollfd{request_, POLLIN, 0}};
    if (poll(files.data(), files.size(), milliseconds) <= 0) return 0;
    ended_ = files[1].revents != 0;
    if (files[2].revents != 0) {
      std::uint64_t count = 0;
      if (read(request_, &count, sizeof count) == sizeof count) return kOwnReason;
    }
    signalfd_siginfo arrival{};
    if (files[0].revents == 0 || read(arrivals_, &arrival, sizeof arrival) != sizeof arrival) return 0;
    return static_cast<int>(arrival.ssi_signo);
  }

  void Listen() {
    int signal = 0;
    while (signal == 0 && !ended_) signal = Wait(-1);
    if (ended_) return;
    stop_signal = signal;
    interrupted = true;
    const bool leaves_end = others_end;
    {
      std::unique_lock lock(TheWorks().mutex);
      Works& works = TheWorks();
      if (!works.registered && !leaves_end) End("");
      if (works.on_signal) works.on_signal(signal == kOwnReason ? SIGTERM : signal);
    }
    if (leaves_end) return;
    // In order, or after the second signal, or after a while.
    const auto first = std::chrono::steady_clock::now();
    const auto deadline = first + kGrace;
    while (!ended_) {
      const auto left =
          std::chrono::duration_cast<std::chrono::milliseconds>(deadline - std::chrono::steady_clock::now());
      const bool again = Wait(static_cast<int>(std::max<std::int64_t>(left.count(), 0))) > 0;
      if (again && std::chrono::steady_clock::now() >= first + kSameRequest) EndAtOnce();
      if (std::chrono::steady_clock::now() >= deadline) break;
    }
    if (!ended_) TakeOver();
    while (!ended_) {
      if (Wait(-1) > 0) EndAtOnce();
    }
  }

  void TakeOver() {
    std::unique_lock lock(TheWorks().mutex);
    Works& works = TheWorks();
    if (works.finished || !works.registered) return;
    End(works.save ? works.save() : "");
  }

  [[noreturn]] void EndAtOnce() const {
    End(" at the second signal: what was found since the last checkpoint is not kept");
  }

  [[noreturn]] void End(const std::string& rest) const {
    std::fprintf(stderr, "%s%s: stopped by %s%s\n", isatty(STDERR_FILENO) != 0 ? "\r\033[K" : "",
                 name_.c_str(), StopName().c_str(),
                 rest.empty() ? " before its end: begin it again" : PrintableLine(rest).c_str());
    RemoveHeldFiles();
    _exit(StopStatus());
  }

  std::string name_;
  sigset_t signals_{};
  sigset_t before_{};
  int arrivals_ = -1;
  int end_;
  int request_;
  bool ended_ = false;
  std::thread thread_;
};

std::unique_ptr<Listener> listener;

}  // namespace

StopSignals::StopSignals(const std::string& name) {
  listener = std::make_unique<Listener>(name);
}

StopSignals::~StopSignals() {
  listener.reset();
}

void LeaveEndToOthers() {
  others_end = true;
}

const std::atomic<bool>& InterruptFlag() {
  return interrupted;
}

void StopFor(const std::string& reason) {
  if (!listener || stop_signal != 0) return;
  {
    const std::lock_guard lock(reason_mutex);
    if (!own_reason.empty()) return;
    own_reason = reason;
  }
  listener->Request();
}

int StopStatus() {
  const int signal = stop_signal;
  return signal == 0 ? 0 : signal == kOwnReason ? kStatusOfOwnReason : 128 + signal;
}

std::string StopName() {
  if (stop_signal == kOwnReason) {
    const std::lock_guard lock(reason_mutex);
    return own_reason;
  }
  return stop_signal == SIGTERM ? "SIGTERM" : "SIGINT";
}

StoppableWork::StoppableWork(Save save, std::function<void(int)> on_signal) {
  Works& works = TheWorks();
  const std::lock_guard lock(works.mutex);
  works.save = std::move(save);
  works.on_signal = std::move(on_signal);
  works.registered = true;
  works.finished = false;
}

StoppableWork::~StoppableWork() {
  Works& works = TheWorks();
  const std::lock_guard lock(works.mutex);
  works.registered = works.finished;  // what was finished stays so, while its result is printed
  works.save = {};
  works.on_signal = {};
}

int StoppableWork::Finish() {
  Works& works = TheWorks();
  const std::lock_guard lock(works.mutex);
  works.finished = true;
  return StopStatus();
}

}  // namespace sinew
