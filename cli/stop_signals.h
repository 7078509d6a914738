// SIGINT (Ctrl-C) and SIGTERM (what a batch system sends): a command stops within a second, whatever it is
// doing, and keeps what it has found.
#pragma once

#include <atomic>
#include <functional>
#include <string>

namespace sinew {

/// Listens to both signals for as long as it lives, in a thread of its own; every other thread that begins
/// meanwhile, and every process that is started, has them blocked. A signal that is ignored when the program
/// begins (nohup) stays ignored.
///
/// The first signal raises InterruptFlag. A command without StoppableWork then ends at once: one sentence on
/// standard error, exit status 128 + signal. The second signal ends every command at once; within 0.3 s of
/// the first it is the same request, passed on twice.
class StopSignals {
 public:
  /// @param name of the program, for its sentence
  explicit StopSignals(const std::string& name);
  ~StopSignals();
  StopSignals(const StopSignals&) = delete;
  StopSignals& operator=(const StopSignals&) = delete;
};

/// A process that works for another one: a signal raises InterruptFlag and nothing more.
void LeaveEndToOthers();

/// Stops the program as the first signal does, for a reason of its own, with exit status 1. Nothing if it is
/// stopping already. @param reason follows "stopped by"
void StopFor(const std::string& reason);

/// Raised by the first signal.
const std::atomic<bool>& InterruptFlag();

/// The exit status that belongs to the signal that came (130 or 143) or to StopFor, or 0.
int StopStatus();

/// "SIGINT" or "SIGTERM", of the signal that came, or the reason of StopFor.
std::string StopName();

/// Work that looks at InterruptFlag and ends in order. If it has not within most of a second, because a
/// single simulation or a factorisation takes longer, the process ends without it.
class StoppableWork {
 public:
  /// What is done at the end instead of the work, in the thread that listens: it writes what there is, and
  /// returns the rest of the sentence "stopped by SIGTERM...", or nothing if there is nothing to be said.
  using Save = std::function<std::string()>;

  /// @param on_signal called at once, may be empty: it passes the signal on to another process
  explicit StoppableWork(Save save, std::function<void(int signal)> on_signal = {});
  ~StoppableWork();
  StoppableWork(const StoppableWork&) = delete;
  StoppableWork& operator=(const StoppableWork&) = delete;

  /// The work has ended, by itself or in order: what it has found is now written, whatever signal comes (the
  /// second one still ends the process). Does not return if the process is ending already.
  /// @return StopStatus() now: a signal that comes later comes too late to stop anything
  int Finish();
};

}  // namespace sinew
