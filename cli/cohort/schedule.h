// Tasks of a cohort in an order in which they can be done, handed to whoever is free.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <functional>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "cli/cohort/pipeline.h"
#include "cli/cohort/task_result.h"

namespace sinew::cohort {

/// Safe in several threads.
class Schedule {
 public:
  /// @param progress how many tasks have ended, of how many; may be empty
  Schedule(const Pipeline& pipeline, std::function<void(int done, int all)> progress);

  /// The next task; nothing if there will be none. Waits while others may make one possible.
  std::optional<std::size_t> Next();
  /// The same without waiting: nothing if there is none now.
  std::optional<std::size_t> NextNow();
  void End(std::size_t task, TaskResult result);
  /// A task that was handed out and not done.
  void PutBack(std::size_t task);

  /// [tasks], in their order.
  std::vector<TaskResult> Results() && { return std::move(results_); }

 private:
  enum class State { kWaiting, kRunning, kEnded };

  std::optional<std::size_t> Take();
  [[nodiscard]] bool Ended(std::size_t task) const;
  [[nodiscard]] bool Ready(std::size_t task) const;

  const Pipeline& pipeline_;
  std::function<void(int, int)> progress_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<TaskResult> results_;
  std::vector<State> state_;
  std::set<std::string> busy_;  // subjects of the tasks that are running
  std::size_t ended_ = 0;
  std::size_t first_open_ = 0;  // all tasks before it have ended
  bool stopped_ = false;
};

}  // namespace sinew::cohort
