#include "cli/cohort/one_task.h"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <map>
#include <set>
#include <utility>

#include "base/digest.h"
#include "base/read_file.h"
#include "base/text.h"
#include "base/version.h"
#include "cli/command.h"
#include "cli/parsed_words.h"

namespace sinew::cohort {
namespace {

namespace fs = std::filesystem;

constexpr const char* kErrorMark = ": error: ";

bool IsFile(const std::string& path) {
  std::error_code code;
  return fs::is_regular_file(path, code);
}

// What the words of a command may name as a file: the word itself, or what follows its '='.
std::vector<std::string> PossibleNames(const std::string& word) {
  std::vector<std::string> names{word};
  if (const auto equals = word.find('='); equals != std::string::npos)
    names.push_back(word.substr(equals + 1));
  return names;
}

// The last error in a log, else its last line.
std::string ReasonIn(const std::string& log, std::size_t from) {
  const auto text = ReadFile(log);
  if (!text || from >= text->size()) return "it said nothing";
  const std::string said = text->substr(from);
  std::string last;
  for (const auto view : Split(said, '\n')) {
    const std::string line(Trim(view));
    if (line.empty()) continue;
    const auto mark = line.find(kErrorMark);
    if (mark != std::string::npos) return line.substr(mark + std::string(kErrorMark).size());
    last = line;
  }
  return last.empty() ? "it said nothing" : last;
}

class OneTask {
 public:
  OneTask(const Pipeline& pipeline, const Task& task, const Program& program, int threads, Children& children)
      : pipeline_(pipeline), task_(task), program_(program), threads_(threads), children_(children) {}

  TaskResult Do(StepStates& states) {
    TaskResult result;
    const std::string log = pipeline_.FolderOf(task_.subject) + "/" + task_.step + ".log";
    const auto inputs = DigestsOf(Inputs());
    if (!inputs) return Failed(result, inputs.error().message);
    const std::string question = QuestionOf(*inputs);
    const StepRecord* before = states.Find(task_.step);
    if (IsFile(pipeline_.Located(log))) result.log = log;
    if (before != nullptr && before->progress == Progress::kDone && before->question == question &&
        IsUnchanged(*before)) {
      result.outcome = Outcome::kKept;
      result.seconds = before->seconds;
      return result;
    }
    const bool goes_on =
        before != nullptr && before->progress == Progress::kBegun && before->question == question;
    result.log = log;
    if (const Status set = states.Set(task_.step, {Progress::kBegun, question, {}, 0, ""}); !set)
      return Failed(result, set.error().message);
    if (!goes_on) {
      std::error_code code;
      fs::remove(pipeline_.Located(log), code);
    }
    const auto began = std::chrono::steady_clock::now();
    Commands(goes_on, pipeline_.Located(log), result);
    result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
    if (result.outcome == Outcome::kStopped) return result;
    StepRecord after{Progress::kFailed, question, {}, result.seconds, ""};
    if (result.outcome == Outcome::kDone) {
      if (const auto again = DigestsOf(Inputs()); !again || *again != *inputs) {
        Failed(result, "a file that it reads was changed meanwhile, by itself or by others");
      } else if (auto written = Written(); !written) {
        Failed(result, written.error().message);
      } else {
        after.progress = Progress::kDone;
        after.written = std::move(*written);
      }
    }
    after.reason = result.reason;
    if (const Status set = states.Set(task_.step, std::move(after)); !set)
      return Failed(result, set.error().message);
    return result;
  }

 private:
  static TaskResult& Failed(TaskResult& result, const std::string& why) {
    result.outcome = Outcome::kFailed;
    result.reason = why;
    return result;
  }

  [[nodiscard]] bool IsWritten(const std::string& name) const {
    const fs::path path = fs::path(name).lexically_normal();
    return std::any_of(task_.written.begin(), task_.written.end(),
                       [&](const std::string& one) { return fs::path(one).lexically_normal() == path; });
  }

  // Every word that names a file which is there and which the task does not make itself.
  [[nodiscard]] std::set<std::string> Inputs() const {
    std::set<std::string> inputs(task_.reads.begin(), task_.reads.end());
    for (const Words& words : task_.commands) {
      for (const std::string& word : words) {
        for (const std::string& name : PossibleNames(word)) {
          if (!IsWritten(name) && IsFile(pipeline_.Located(name))) inputs.insert(name);
        }
      }
    }
    return inputs;
  }

  [[nodiscard]] Result<std::map<std::string, std::string>> DigestsOf(
      const std::set<std::string>& names) const {
    std::map<std::string, std::string> digests;
    for (const std::string& name : names) {
      SINEW_ASSIGN(digests[name], DigestOfFile(pipeline_.Located(name)));
    }
    return digests;
  }

  [[nodiscard]] std::string QuestionOf(const std::map<std::string, std::string>& inputs) const {
    Digest digest;
    digest.Add(kVersion);
    for (const Words& words : task_.commands) {
      digest.Add(static_cast<std::uint64_t>(words.size()));
      for (const std::string& word : words) digest.Add(word);
    }
    for (const auto& [name, bytes] : inputs) digest.Add(name).Add(bytes);
    return ToHex(digest.value());
  }

  [[nodiscard]] Result<std::map<std::string, std::string>> Written() const {
    std::map<std::string, std::string> written;
    for (const std::string& name : task_.written) {
      const std::string path = pipeline_.Located(name);
      std::error_code code;
      if (fs::is_directory(path, code)) {
        written[name] = "";
        continue;
      }
      SINEW_ASSIGN(written[name], DigestOfFile(path));
    }
    return written;
  }

  [[nodiscard]] bool IsUnchanged(const StepRecord& record) const {
    const auto written = Written();
    return written && *written == record.written;
  }

  // One after the other, until one does not end well.
  void Commands(bool goes_on, const std::string& log, TaskResult& result) const {
    for (const Words& command : task_.commands) {
      Words words = command;
      const auto parsed = ParseWords(program_, words);
      if (!parsed) return static_cast<void>(Failed(result, parsed.error().message));
      const auto add = [&](const char* option, Words more) {
        if (parsed->options.count(option) > 0 && parsed->given.count(option) == 0)
          words.insert(words.end(), more.begin(), more.end());
      };
      add("--threads", {"--threads", std::to_string(threads_)});
      add("--quiet", {"--quiet"});
      if (goes_on && !parsed->written.empty() && IsFile(pipeline_.Located(parsed->written.front())))
        add("--resume", {"--resume"});
      std::error_code code;
      const auto before = fs::file_size(log, code);
      const auto status = children_.Run(words, pipeline_.folder, fs::absolute(log).string());
      if (!status) return static_cast<void>(Failed(result, status.error().message));
      if (*status == kDone) continue;
      if (*status == 128 + SIGINT || *status == 128 + SIGTERM) {
        result.outcome = Outcome::kStopped;
        return;
      }
      const std::string why = *status > 128 ? fmt::format("it was ended by signal {}", *status - 128)
                                            : ReasonIn(log, code ? 0 : before);
      return static_cast<void>(Failed(result, why));
    }
    result.outcome = Outcome::kDone;
  }

  const Pipeline& pipeline_;
  const Task& task_;
  const Program& program_;
  int threads_;
  Children& children_;
};

}  // namespace

TaskResult DoTask(const Pipeline& pipeline, const Task& task, const Program& program, int threads,
                  Children& children) {
  auto states = StepStates::Read(pipeline.Located(pipeline.FolderOf(task.subject)));
  if (!states) {
    TaskResult failed;
    failed.outcome = Outcome::kFailed;
    failed.reason = states.error().message;
    return failed;
  }
  return OneTask(pipeline, task, program, threads, children).Do(*states);
}

}  // namespace sinew::cohort
