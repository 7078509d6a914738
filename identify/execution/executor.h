// How independent pieces of work are done: one after the other, or by several threads. Starts of a search,
// refits, cross-validation folds, profiles and trials all pass through here.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>

namespace sinew {

/// Runs pieces of work that do not depend on each other. A piece writes only its own result, and results are
/// combined in the order of their index, so that the answer is the same whatever executor is used.
class Executor {
 public:
  /// @param index of the piece, 0 .. count - 1
  /// @param worker that runs it, 0 .. workers() - 1; no two pieces run by one worker overlap, so that scratch
  /// memory may be kept per worker.
  using Work = std::function<void(std::size_t index, std::size_t worker)>;

  Executor() = default;
  virtual ~Executor() = default;
  Executor(const Executor&) = delete;
  Executor& operator=(const Executor&) = delete;

  /// Calls work(0) .. work(count - 1), each once, in any order, and returns when all have ended. An exception
  /// of a piece is thrown again here, once no other piece is running.
  virtual void ForEach(std::size_t count, const Work& work) const = 0;
  /// [>= 1] how many pieces may run at once.
  [[nodiscard]] virtual std::size_t workers() const = 0;
};

/// In the calling thread for `threads` <= 1, else with that many threads, or as many as the machine has if
/// these are fewer.
[[nodiscard]] std::unique_ptr<Executor> MakeExecutor(int threads);

/// With the threads that the caller may use: those of the executor that runs it, or all that the program is
/// allowed.
[[nodiscard]] const Executor& CurrentExecutor();

}  // namespace sinew
