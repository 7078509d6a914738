#include "cli/cohort/pipeline.h"

#include <algorithm>
#include <filesystem>
#include <set>
#include <utility>

#include "base/read_file.h"
#include "base/text.h"
#include "base/yaml_reader.h"
#include "cli/parsed_words.h"

namespace sinew::cohort {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxSubjects = 100000;

using Values = std::map<std::string, std::string>;

struct Subject {
  std::string name;
  Values values;  // placeholders of its own
};

struct Step {
  std::string name;
  long line = 0;
  std::vector<Words> commands;
  std::vector<std::string> after;
  std::vector<std::string> reads;
};

// Names become folders and placeholders.
bool IsName(const std::string& text) {
  const auto fits = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
           c == '-' || c == '.';
  };
  return !text.empty() && text.front() != '.' && text.front() != '-' &&
         std::all_of(text.begin(), text.end(), fits);
}

Status CheckName(const YamlReader& at, const std::string& name) {
  if (IsName(name)) return {};
  return FailAt(at.file(), at.line(), "'{}' is no name: expected letters, digits, '_', '-' and '.'", name);
}

// "*.h5": every file of the folder that matches, by name; the subject is what the star stands for.
Result<std::vector<Subject>> MatchingSubjects(const YamlReader& at, const std::string& folder,
                                              const std::string& pattern) {
  const auto star = pattern.find('*');
  const auto slash = pattern.rfind('/');
  const std::size_t begin = slash == std::string::npos ? 0 : slash + 1;
  if (star == std::string::npos || star < begin || pattern.find('*', star + 1) != std::string::npos)
    return FailAt(at.file(), at.line(), "subjects: expected names, or one pattern as data/*.h5");
  const std::string before = pattern.substr(begin, star - begin);
  const std::string after = pattern.substr(star + 1);
  std::vector<Subject> subjects;
  std::error_code code;
  const fs::path in = fs::path(folder) / pattern.substr(0, begin);
  for (const auto& entry : fs::directory_iterator(in, code)) {
    const std::string name = entry.path().filename().string();
    if (name.size() <= before.size() + after.size() || name.rfind(before, 0) != 0 ||
        name.compare(name.size() - after.size(), after.size(), after) != 0)
      continue;
    const std::string subject = name.substr(before.size(), name.size() - before.size() - after.size());
    SINEW_TRY(CheckName(at, subject));
    subjects.push_back({subject, {{"file", pattern.substr(0, begin) + name}}});
  }
  if (code) return FailAt(at.file(), at.line(), "subjects: {}: {}", in.string(), code.message());
  std::sort(subjects.begin(), subjects.end(),
            [](const Subject& a, const Subject& b) { return a.name < b.name; });
  return subjects;
}

Result<std::vector<Subject>> ReadSubjects(const YamlReader& root, const std::string& folder) {
  SINEW_ASSIGN(const YamlReader at, root.At("subjects"));
  std::vector<Subject> subjects;
  if (at.is_map()) {
    SINEW_ASSIGN(const std::vector<std::string> names, at.Keys());
    for (const std::string& name : names) {
      SINEW_TRY(CheckName(at, name));
      SINEW_ASSIGN(const YamlReader own, at.At(name));
      Subject subject{name, {}};
      SINEW_ASSIGN(const std::vector<std::string> keys, own.Keys());
      for (const std::string& key : keys) {
        SINEW_ASSIGN(const YamlReader value, own.At(key));
        SINEW_ASSIGN(subject.values[key], value.Text());
      }
      subjects.push_back(std::move(subject));
    }
  } else if (const auto list = at.Items(); list) {
    for (const YamlReader& item : *list) {
      SINEW_ASSIGN(const std::string name, item.Text());
      SINEW_TRY(CheckName(item, name));
      subjects.push_back({name, {}});
    }
  } else {
    SINEW_ASSIGN(const std::string pattern, at.Text());
    SINEW_ASSIGN(subjects, MatchingSubjects(at, folder, pattern));
  }
  if (subjects.empty()) return FailAt(at.file(), at.line(), "subjects: there is none");
  if (subjects.size() > kMaxSubjects)
    return FailAt(at.file(), at.line(), "subjects: {} are more than {}", subjects.size(), kMaxSubjects);
  std::set<std::string> seen;
  for (const Subject& subject : subjects) {
    if (!seen.insert(subject.name).second)
      return FailAt(at.file(), at.line(), "subjects: '{}' is there twice", subject.name);
  }
  return subjects;
}

// "identify nms --data {import}", or a list of words, which may hold blanks.
Result<Words> ReadWords(const YamlReader& at) {
  Words words;
  if (const auto list = at.Texts(); list) {
    words = *list;
  } else {
    SINEW_ASSIGN(const std::string text, at.Text());
    for (const auto word : SplitBlanks(text)) words.emplace_back(word);
  }
  if (words.empty()) return FailAt(at.file(), at.line(), "expected the words of a command");
  return words;
}

// One command as a text, or several as a list.
Result<std::vector<Words>> ReadCommands(const YamlReader& at) {
  std::vector<Words> commands;
  if (const auto list = at.Items(); list) {
    for (const YamlReader& item : *list) {
      SINEW_ASSIGN(Words words, ReadWords(item));
      commands.push_back(std::move(words));
    }
    if (commands.empty()) return FailAt(at.file(), at.line(), "expected a command");
    return commands;
  }
  SINEW_ASSIGN(Words words, ReadWords(at));
  commands.push_back(std::move(words));
  return commands;
}

Result<std::vector<Step>> ReadSteps(const YamlReader& root) {
  SINEW_ASSIGN(const YamlReader at, root.At("steps"));
  SINEW_ASSIGN(const std::vector<std::string> names, at.Keys());
  std::vector<Step> steps;
  for (const std::string& name : names) {
    SINEW_TRY(CheckName(at, name));
    SINEW_ASSIGN(const YamlReader one, at.At(name));
    Step step{name, one.line(), {}, {}, {}};
    if (name == "subject" || name == "out")
      return FailAt(at.file(), one.line(), "steps: '{}' is the name of a placeholder", name);
    if (one.is_map()) {
      SINEW_TRY(one.OnlyKeys({"run", "after", "reads"}));
      SINEW_ASSIGN(const YamlReader run, one.At("run"));
      SINEW_ASSIGN(step.commands, ReadCommands(run));
      for (const auto& [key, texts] : {std::pair{"after", &step.after}, std::pair{"reads", &step.reads}}) {
        if (!one.Has(key)) continue;
        SINEW_ASSIGN(const YamlReader list, one.At(key));
        SINEW_ASSIGN(*texts, list.Texts());
      }
    } else {
      SINEW_ASSIGN(step.commands, ReadCommands(one));
    }
    steps.push_back(std::move(step));
  }
  if (steps.empty()) return FailAt(at.file(), at.line(), "steps: there is none");
  return steps;
}

// Placeholders are names in braces. @param used the placeholders that were found are added
Result<std::string> Filled(const std::string& text, const Values& values, const std::string& file,
                           const Step& step, std::set<std::string>& used) {
  std::string filled;
  for (std::size_t at = 0; at < text.size();) {
    const auto end = text[at] == '{' ? text.find('}', at) : std::string::npos;
    if (end == std::string::npos) {
      filled += text[at++];
      continue;
    }
    const std::string name = text.substr(at + 1, end - at - 1);
    const auto value = values.find(name);
    if (value == values.end()) {
      std::vector<std::string> known;
      for (const auto& [key, unused] : values) known.push_back(key);
      return FailAt(file, step.line, "step '{}': {{{}}} stands for nothing here{}", step.name, name,
                    Suggestion(name, known));
    }
    filled += value->second;
    used.insert(name);
    at = end + 1;
  }
  return filled;
}

// The steps in an order in which each comes after those whose results it uses.
Result<std::vector<Step>> Ordered(std::vector<Step> steps, const std::string& file) {
  std::vector<std::string> names;
  for (const Step& step : steps) names.push_back(step.name);
  for (Step& step : steps) {
    for (const std::string& before : step.after) {
      if (std::find(names.begin(), names.end(), before) == names.end())
        return FailAt(file, step.line, "step '{}': after '{}'{}", step.name, before,
                      Suggestion(before, names));
    }
    for (const std::string& other : names) {
      const auto uses = [&](const std::string& word) {
        return word.find("{" + other + "}") != std::string::npos;
      };
      bool used = std::any_of(step.reads.begin(), step.reads.end(), uses);
      for (const Words& words : step.commands) used = used || std::any_of(words.begin(), words.end(), uses);
      if (used && other != step.name) step.after.push_back(other);
    }
  }
  std::vector<Step> ordered;
  const auto is_there = [&](const std::string& name) {
    return std::any_of(ordered.begin(), ordered.end(), [&](const Step& step) { return step.name == name; });
  };
  while (!steps.empty()) {
    const auto next = std::find_if(steps.begin(), steps.end(), [&](const Step& step) {
      return std::all_of(step.after.begin(), step.after.end(), is_there);
    });
    if (next == steps.end())
      return FailAt(file, steps.front().line, "step '{}': waits for itself", steps.front().name);
    ordered.push_back(std::move(*next));
    steps.erase(next);
  }
  return ordered;
}

class Expansion {
 public:
  Expansion(Pipeline& pipeline, const Program& program, std::string file)
      : pipeline_(pipeline), program_(program), file_(std::move(file)) {}

  Status AddSubject(const Subject& subject, const std::vector<Step>& steps) {
    Values values = subject.values;
    for (const Step& step : steps) {
      if (values.count(step.name) > 0)
        return FailAt(file_, step.line, "'{}' is a step and a value of subject {}", step.name, subject.name);
    }
    values["subject"] = subject.name;
    values["out"] = pipeline_.FolderOf(subject.name);
    std::map<std::string, std::size_t> task_of;
    for (const Step& step : steps) {
      SINEW_ASSIGN(Task task, TaskOf(subject, step, values));
      for (const std::string& before : step.after) task.after.push_back(task_of.at(before));
      values[step.name] = task.written.front();
      task_of[step.name] = pipeline_.tasks.size();
      pipeline_.tasks.push_back(std::move(task));
    }
    return {};
  }

 private:
  Result<Task> TaskOf(const Subject& subject, const Step& step, const Values& values) {
    Task task{subject.name, step.name, {}, {}, {}, {}};
    std::set<std::string> used;
    for (const Words& words : step.commands) {
      Words filled;
      for (const std::string& word : words) {
        SINEW_ASSIGN(std::string one, Filled(word, values, file_, step, used));
        filled.push_back(std::move(one));
      }
      const auto parsed = ParseWords(program_, filled);
      if (!parsed)
        return FailAt(file_, step.line, "step '{}' of {}: {}", step.name, subject.name,
                      parsed.error().message);
      if (parsed->command == "run") return FailAt(file_, step.line, "step '{}': run runs itself", step.name);
      task.written.insert(task.written.end(), parsed->written.begin(), parsed->written.end());
      task.commands.push_back(std::move(filled));
    }
    for (const std::string& read : step.reads) {
      SINEW_ASSIGN(std::string one, Filled(read, values, file_, step, used));
      task.reads.push_back(std::move(one));
    }
    if (task.written.empty())
      return FailAt(
          file_, step.line,
          "step '{}': writes no file of its own: expected --out or --out-dir; a command that changes "
          "its data set in place belongs into the step that makes it, after the command that does",
          step.name);
    for (const std::string& path : task.written) {
      const auto [other, is_new] =
          written_.emplace(fs::path(path).lexically_normal().string(), subject.name + ", " + step.name);
      if (!is_new)
        return FailAt(file_, step.line, "step '{}' of {}: {} is written by {} too", step.name, subject.name,
                      path, other->second);
    }
    return task;
  }

  Pipeline& pipeline_;
  const Program& program_;
  std::string file_;
  std::map<std::string, std::string> written_;  // path -> by what
};

}  // namespace

std::string Pipeline::Located(const std::string& path) const {
  return folder == "." ? path : (fs::path(folder) / path).string();
}

Result<Pipeline> ReadPipeline(const std::string& path, const Program& program) {
  SINEW_ASSIGN(const std::string text, ReadFile(path));
  SINEW_ASSIGN(const YamlReader root, YamlReader::Parse(text, path));
  SINEW_TRY(root.OnlyKeys({"subjects", "out", "steps"}));
  Pipeline pipeline;
  const fs::path folder = fs::path(path).parent_path();
  pipeline.folder = folder.empty() ? "." : folder.string();
  SINEW_ASSIGN(const YamlReader out, root.At("out"));
  SINEW_ASSIGN(pipeline.out, out.Text());
  while (pipeline.out.size() > 1 && pipeline.out.back() == '/') pipeline.out.pop_back();
  if (pipeline.out.empty()) return FailAt(path, out.line(), "out: expected the name of a folder");
  SINEW_ASSIGN(const std::vector<Subject> subjects, ReadSubjects(root, pipeline.folder));
  SINEW_ASSIGN(std::vector<Step> steps, ReadSteps(root));
  for (const Step& step : steps) pipeline.steps.push_back(step.name);
  SINEW_ASSIGN(steps, Ordered(std::move(steps), path));
  Expansion expansion(pipeline, program, path);
  for (const Subject& subject : subjects) {
    pipeline.subjects.push_back(subject.name);
    SINEW_TRY(expansion.AddSubject(subject, steps));
  }
  return pipeline;
}

}  // namespace sinew::cohort
