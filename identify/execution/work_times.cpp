#include "identify/execution/work_times.h"

#include <ctime>

#include "base/constants.h"

namespace sinew {
namespace {

double Now(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace

double WorkTimes::OfProcess() {
  return Now(CLOCK_PROCESS_CPUTIME_ID);
}
double WorkTimes::OfThread() {
  return Now(CLOCK_THREAD_CPUTIME_ID);
}

std::size_t WorkTimes::Begin(std::size_t pieces) {
  const std::lock_guard lock(mutex_);
  loops_.push_back({std::vector<double>(pieces, kNaN), OfProcess(), 0, 0});
  return loops_.size() - 1;
}

void WorkTimes::SetPiece(std::size_t loop, std::size_t piece, double seconds) {
  const std::lock_guard lock(mutex_);
  loops_[loop].pieces[piece] = seconds;
}

void WorkTimes::End(std::size_t loop, double repeated) {
  const std::lock_guard lock(mutex_);
  loops_[loop].ended = OfProcess();
  loops_[loop].repeated = repeated;
}

std::vector<WorkTimes::Loop> WorkTimes::loops() const {
  const std::lock_guard lock(mutex_);
  return loops_;
}

}  // namespace sinew
