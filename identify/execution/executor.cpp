#include "identify/execution/executor.h"

#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>

namespace sinew {
namespace {

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
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
    const auto worker = static_cast<std::size_t>(std::max(0, tbb::this_task_arena::current_thread_index()));
    tbb::this_task_arena::isolate([&] { work(i, worker); });
  });
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
