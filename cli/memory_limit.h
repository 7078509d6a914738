// --max-memory: the program stops in order before the system ends it.
#pragma once

#include <condition_variable>
#include <mutex>
#include <optional>
#include <thread>

#include "cli/command.h"

namespace sinew {

/// Looks at the memory of this process (ResidentMemory) every 20 ms, in a thread of its own, and stops the
/// program as a signal does (StopFor) once it takes as much as it may. Work that keeps what it has found
/// writes it, and --resume with more goes on. Not what other processes take (ranks, steps of a cohort).
class MemoryLimit {
 public:
  /// Nothing is looked at before Begin. @param megabytes nothing: no limit
  explicit MemoryLimit(std::optional<double> megabytes) : megabytes_(megabytes) {}
  ~MemoryLimit();
  MemoryLimit(const MemoryLimit&) = delete;
  MemoryLimit& operator=(const MemoryLimit&) = delete;

  /// The first call counts. A process that already takes too much is stopped before this returns.
  void Begin();

 private:
  /// Stops the program if it takes too much. @return whether it does
  [[nodiscard]] bool StopsNow() const;
  void Watch();

  std::optional<double> megabytes_;
  std::mutex mutex_;
  std::condition_variable ended_;
  bool ends_ = false;
  std::thread thread_;
};

/// "--max-memory MB".
void AddMaxMemoryTo(Command command, std::optional<double>& megabytes, const std::string& meaning);

}  // namespace sinew
