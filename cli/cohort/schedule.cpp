#include "cli/cohort/schedule.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace sinew::cohort {

Schedule::Schedule(const Pipeline& pipeline, std::function<void(int, int)> progress)
    : pipeline_(pipeline),
      progress_(std::move(progress)),
      results_(pipeline.tasks.size()),
      state_(pipeline.tasks.size()) {}

std::optional<std::size_t> Schedule::Next() {
  std::unique_lock lock(mutex_);
  for (;;) {
    if (const auto task = Take()) return task;
    // One that is being done may be put back.
    if (stopped_ || ended_ == state_.size()) return std::nullopt;
    changed_.wait(lock);
  }
}

std::optional<std::size_t> Schedule::NextNow() {
  const std::lock_guard lock(mutex_);
  return Take();
}

std::optional<std::size_t> Schedule::Take() {
  while (first_open_ < state_.size() && state_[first_open_] == State::kEnded) ++first_open_;
  for (std::size_t i = first_open_; i < state_.size() && !stopped_; ++i) {
    if (state_[i] != State::kWaiting || !Ready(i)) continue;
    state_[i] = State::kRunning;
    busy_.insert(pipeline_.tasks[i].subject);
    return i;
  }
  return std::nullopt;
}

void Schedule::PutBack(std::size_t task) {
  const std::lock_guard lock(mutex_);
  state_[task] = State::kWaiting;
  busy_.erase(pipeline_.tasks[task].subject);
  changed_.notify_all();
}

void Schedule::End(std::size_t task, TaskResult result) {
  const std::lock_guard lock(mutex_);
  stopped_ = stopped_ || result.outcome == Outcome::kStopped;
  results_[task] = std::move(result);
  state_[task] = State::kEnded;
  const std::string& subject = pipeline_.tasks[task].subject;
  busy_.erase(subject);
  ++ended_;
  // What comes after a failure is not run; tasks stand subject by subject, and each comes after its own.
  for (std::size_t i = task + 1; i < state_.size() && pipeline_.tasks[i].subject == subject; ++i) {
    if (state_[i] != State::kWaiting) continue;
    for (const std::size_t before : pipeline_.tasks[i].after) {
      if (state_[before] != State::kEnded || Ended(before)) continue;
      state_[i] = State::kEnded;
      ++ended_;
      results_[i].outcome = Outcome::kNotRun;
      results_[i].reason = fmt::format("after {}", pipeline_.tasks[before].step);
      break;
    }
  }
  if (progress_) progress_(static_cast<int>(ended_), static_cast<int>(state_.size()));
  changed_.notify_all();
}

bool Schedule::Ended(std::size_t task) const {
  return results_[task].outcome == Outcome::kDone || results_[task].outcome == Outcome::kKept;
}

bool Schedule::Ready(std::size_t task) const {
  const Task& wanted = pipeline_.tasks[task];
  // One step of a subject at a time: they share a record of steps.
  if (busy_.count(wanted.subject) != 0) return false;
  return std::all_of(wanted.after.begin(), wanted.after.end(),
                     [&](std::size_t before) { return state_[before] == State::kEnded && Ended(before); });
}

}  // namespace sinew::cohort
