// The steps that are done for every subject of a cohort, as a file describes them (docs/cohorts.md).
#pragma once

#include <map>
#include <string>
#include <vector>

#include "base/error.h"
#include "cli/run_command_line.h"

namespace sinew::cohort {

using Words = std::vector<std::string>;

/// One step of one subject, with the words of its commands as they are run.
struct Task {
  std::string subject;
  std::string step;
  std::vector<Words> commands;
  std::vector<std::string> written;  ///< files and folders, as the words name them; not empty
  std::vector<std::string> reads;    ///< files besides those among the words
  std::vector<std::size_t> after;    ///< tasks of the same subject that have to be done before
};

struct Pipeline {
  std::string folder;                 ///< that of the file: what its commands' names are relative to
  std::string out;                    ///< folder of all results, relative to that
  std::vector<std::string> subjects;  ///< in the order of the file
  std::vector<std::string> steps;     ///< the same
  std::vector<Task> tasks;            ///< subject by subject, in an order in which they can be done

  /// The folder of one subject's results, relative to `folder`.
  [[nodiscard]] std::string FolderOf(const std::string& subject) const { return out + "/" + subject; }
  /// With the folder in front, unless it is absolute.
  [[nodiscard]] std::string Located(const std::string& path) const;
};

/// Reads a pipeline and checks every command of every subject, so that nothing is begun that cannot be done.
/// Errors, with the file's line: unknown keys, names and placeholders, steps that wait for each other, words
/// that a command does not take, a step that writes nothing, two that write the same.
Result<Pipeline> ReadPipeline(const std::string& path, const Program& program);

}  // namespace sinew::cohort
