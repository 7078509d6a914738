#include "cli/memory_limit.h"

#include <chrono>

#include "base/process_memory.h"
#include "base/text.h"
#include "cli/mpi_ranks.h"
#include "cli/stop_signals.h"

namespace sinew {
namespace {

constexpr std::chrono::milliseconds kBetweenLooks{20};
constexpr int kMostLooks = 100;  // for a stop that was asked for

}  // namespace

MemoryLimit::~MemoryLimit() {
  {
    const std::lock_guard lock(mutex_);
    ends_ = true;
  }
  ended_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void MemoryLimit::Begin() {
  // Of several ranks the others have nothing to save: they end when rank 0 does.
  if (!megabytes_ || IsHelper() || thread_.joinable()) return;
  if (StopsNow()) {
    // Short work would otherwise end before the stop arrives, or not, as the machine is busy.
    for (int look = 0; look < kMostLooks && !InterruptFlag(); ++look)
      std::this_thread::sleep_for(kBetweenLooks);
    return;
  }
  thread_ = std::thread([this] { Watch(); });
}

bool MemoryLimit::StopsNow() const {
  const double taken = static_cast<double>(ResidentMemory()) / 1e6;
  if (taken < *megabytes_) return false;
  StopFor(fmt::format("--max-memory {:.6g}: the process takes {:.4g} MB", *megabytes_, taken));
  return true;
}

void MemoryLimit::Watch() {
  std::unique_lock lock(mutex_);
  while (!ends_ && !StopsNow()) ended_.wait_for(lock, kBetweenLooks);
}

void AddMaxMemoryTo(Command command, std::optional<double>& megabytes, const std::string& meaning) {
  command.Add("--max-memory", megabytes, meaning).AtLeastZero().Shows("MB");
}

}  // namespace sinew
