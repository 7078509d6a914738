#include "cli/cohort/cohort_run.h"

#include <algorithm>
#include <atomic>
#include <csignal>
#include <deque>
#include <filesystem>
#include <thread>
#include <utility>

#include "base/digest.h"
#include "cli/cohort/one_task.h"
#include "cli/cohort/schedule.h"

namespace sinew::cohort {
namespace {

namespace fs = std::filesystem;

/// How the processor cores of all processes, as many on each as on this one, are divided among the subjects.
struct Shares {
  int at_once = 1;  ///< tasks of this process
  int threads = 1;  ///< of each task
};

Shares SharesOf(const Pipeline& pipeline, const CohortOptions& options) {
  const int processes = options.ranks == nullptr ? 1 : options.ranks->size();
  const auto subjects = static_cast<int>(std::max<std::size_t>(1, pipeline.subjects.size()));
  Shares shares;
  shares.threads = std::clamp(options.threads * processes / subjects, 1, options.threads);
  shares.at_once = std::clamp(options.threads / shares.threads, 1, subjects);
  return shares;
}

Digest::Value NameOf(const Task& task) {
  Digest digest;
  digest.Add(task.subject).Add(task.step);
  for (const Words& words : task.commands) {
    for (const std::string& word : words) digest.Add(word);
  }
  return digest.value();
}

// The reason and the log, which hold no such character, are one text.
constexpr char kBetween = '\0';

Message ToMessage(const Task& task, std::size_t index, const TaskResult& result) {
  return {Message::Kind::kTask,
          NameOf(task),
          index,
          {{static_cast<double>(static_cast<int>(result.outcome)), result.seconds},
           result.reason + kBetween + result.log}};
}

TaskResult FromMessage(const Message& message) {
  TaskResult result;
  if (message.answer.numbers.size() != 2) return result;
  result.outcome = static_cast<Outcome>(static_cast<int>(message.answer.numbers[0]));
  result.seconds = message.answer.numbers[1];
  const auto between = message.answer.text.find(kBetween);
  if (between == std::string::npos) return result;
  result.reason = message.answer.text.substr(0, between);
  result.log = message.answer.text.substr(between + 1);
  return result;
}

// Hands tasks to other processes until there are no more.
class OtherProcesses {
 public:
  OtherProcesses(Ranks& ranks, const Pipeline& pipeline, Schedule& schedule, Children& children)
      : ranks_(ranks), pipeline_(pipeline), schedule_(schedule), children_(children) {}

  /// @param done whether this process has done all tasks that were left to it
  void Serve(const std::function<bool()>& done) {
    while (running_ > 0 || !done()) {
      HandOut();
      if (children_.stopped() && !std::exchange(told_, true)) {
        for (int rank = 1; rank < ranks_.size(); ++rank)
          ranks_.Send(rank, {Message::Kind::kReady, {}, 0, {}});
      }
      const auto received = ranks_.Await();
      if (!received) continue;
      const Message& message = received->message;
      if (message.kind == Message::Kind::kReady) {
        idle_.insert(idle_.end(), message.index, received->from);
      } else if (message.index < pipeline_.tasks.size()) {
        TakeBack(received->from, message);
      }
    }
  }

 private:
  void HandOut() {
    while (!idle_.empty()) {
      const auto task = schedule_.NextNow();
      if (!task) return;
      ranks_.Send(idle_.front(), {Message::Kind::kTask, NameOf(pipeline_.tasks[*task]), *task, {}});
      idle_.pop_front();
      ++running_;
    }
  }

  void TakeBack(int from, const Message& message) {
    --running_;
    TaskResult result = FromMessage(message);
    // A process that alone was told to stop gets no more.
    if (result.outcome == Outcome::kStopped && !children_.stopped()) return schedule_.PutBack(message.index);
    schedule_.End(message.index, std::move(result));
    idle_.push_back(from);
  }

  Ranks& ranks_;
  const Pipeline& pipeline_;
  Schedule& schedule_;
  Children& children_;
  std::deque<int> idle_;  // ranks, once for every task that they can do at once
  int running_ = 0;
  bool told_ = false;
};

}  // namespace

Result<std::vector<TaskResult>> RunCohort(const Pipeline& pipeline, const Program& program,
                                          const CohortOptions& options, Children& children) {
  for (const std::string& subject : pipeline.subjects) {
    const std::string folder = pipeline.Located(pipeline.FolderOf(subject));
    std::error_code code;
    fs::create_directories(folder, code);
    if (code) return Fail("{}: {}", folder, code.message());
    SINEW_TRY(StepStates::Read(folder));
  }
  Schedule schedule(pipeline, options.progress);
  const Shares shares = SharesOf(pipeline, options);
  std::atomic<int> working = shares.at_once;
  std::vector<std::thread> threads;
  for (int w = 0; w < shares.at_once; ++w) {
    threads.emplace_back([&] {
      while (const auto next = schedule.Next())
        schedule.End(*next, DoTask(pipeline, pipeline.tasks[*next], program, shares.threads, children));
      --working;
    });
  }
  if (options.ranks != nullptr) {
    OtherProcesses(*options.ranks, pipeline, schedule, children).Serve([&] { return working == 0; });
  }
  for (std::thread& thread : threads) thread.join();
  return std::move(schedule).Results();
}

void HelpWithCohort(const Pipeline& pipeline, const Program& program, const CohortOptions& options,
                    Children& children, const std::function<bool()>& told_to_stop) {
  Ranks& ranks = *options.ranks;
  const Shares shares = SharesOf(pipeline, options);
  std::atomic<int> working = 0;
  std::vector<std::thread> threads;
  ranks.Send(0, {Message::Kind::kReady, {}, static_cast<std::uint64_t>(shares.at_once), {}});
  while (!told_to_stop() || working > 0) {
    const auto received = ranks.Await();
    if (!received) continue;
    const std::size_t index = received->message.index;
    if (received->message.kind == Message::Kind::kReady) {
      children.Stop(SIGTERM);
      continue;
    }
    // Other subjects may fit a pattern by the time that this process looks.
    if (index >= pipeline.tasks.size() || NameOf(pipeline.tasks[index]) != received->message.about) {
      ranks.Send(0, {Message::Kind::kTask, {}, index, {}});
      continue;
    }
    ++working;
    threads.emplace_back([&, index] {
      const Task& task = pipeline.tasks[index];
      ranks.Send(0, ToMessage(task, index, DoTask(pipeline, task, program, shares.threads, children)));
      --working;
    });
  }
  for (std::thread& thread : threads) thread.join();
}

}  // namespace sinew::cohort
