#include "identify/execution/executor.h"

#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <vector>

#ifdef __SANITIZE_THREAD__
#include <sanitizer/tsan_interface.h>
#endif

namespace sinew {
namespace {

// What TBB's threads hand over to each other, as the thread sanitizer is to see it: the library is not built
// with it, and without this every piece would seem to race with the caller. Pieces that run at the same time
// stay unordered, so that a race between them is found.
#ifdef __SANITIZE_THREAD__
class HandOver {
 public:
  explicit HandOver(int workers) : scratch_(static_cast<std::size_t>(workers)) {}

  // Of all work at once: a piece may not look at anything of its caller's before it.
  static void Begin() { __tsan_release(&begin); }
  static void Arrive() { __tsan_acquire(&begin); }
  void BeginPiece(std::size_t worker) { __tsan_acquire(&scratch_[worker]); }
  void EndPiece(std::size_t worker) {
    __tsan_release(&scratch_[worker]);
    __tsan_release(&end_);
  }
  void End() { __tsan_acquire(&end_); }

 private:
  inline static char begin = 0;
  char end_ = 0;
  std::vector<char> scratch_;  // of each worker: its memory may pass from thread to thread
};
#else
class HandOver {
 public:
  explicit HandOver(int /*workers*/) {}
  static void Begin() {}
  static void Arrive() {}
  void BeginPiece(std::size_t /*worker*/) {}
  void EndPiece(std::size_t /*worker*/) {}
  void End() {}
};
#endif

class SerialExecutor final : public Executor {
 public:
  void ForEach(std::size_t count, const Work& work) const override {
    for (std::size_t i = 0; i < count; ++i) work(i, 0);
  }
  [[nodiscard]] std::size_t workers() const override { return 1; }
};

// A piece that waits for work of its own (a prediction that runs its trials in parallel) may not begin
// another piece of the outer loop in the meantime: that would share the worker's scratch memory. So each is
// isolated.
void ForEachInArena(std::size_t count, const Executor::Work& work) {
  HandOver hand_over(tbb::this_task_arena::max_concurrency());
  const auto piece = [&](std::size_t i) {
    HandOver::Arrive();
    const auto worker = static_cast<std::size_t>(std::max(0, tbb::this_task_arena::current_thread_index()));
    hand_over.BeginPiece(worker);
    tbb::this_task_arena::isolate([&] { work(i, worker); });
    hand_over.EndPiece(worker);
  };
  HandOver::Begin();
  tbb::parallel_for(std::size_t{0}, count, piece);
  hand_over.End();
}

class ThreadExecutor final : public Executor {
 public:
  explicit ThreadExecutor(int threads) : arena_(threads) {}
  void ForEach(std::size_t count, const Work& work) const override {
    arena_.execute([&] { ForEachInArena(count, work); });
  }
  [[nodiscard]] std::size_t workers() const override {
    return static_cast<std::size_t>(arena_.max_concurrency());
  }

 private:
  mutable tbb::task_arena arena_;
};

class ArenaOfTheCaller final : public Executor {
 public:
  void ForEach(std::size_t count, const Work& work) const override { ForEachInArena(count, work); }
  [[nodiscard]] std::size_t workers() const override {
    return static_cast<std::size_t>(tbb::this_task_arena::max_concurrency());
  }
};

}  // namespace

std::unique_ptr<Executor> MakeExecutor(int threads) {
  // TBB complains of more threads than the machine has.
  const int usable = std::min(threads, tbb::info::default_concurrency());
  if (usable <= 1) return std::make_unique<SerialExecutor>();
  return std::make_unique<ThreadExecutor>(usable);
}

const Executor& CurrentExecutor() {
  static const ArenaOfTheCaller kExecutor;
  return kExecutor;
}

}  // namespace sinew
