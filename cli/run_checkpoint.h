// The run file of an identification that is still going on.
#pragma once

#include <cstddef>
#include <string>

#include "cli/terminal.h"
#include "identify/files/run_file.h"

namespace sinew {

/// Saves a search every few seconds, and whenever it is asked to.
class RunCheckpoint {
 public:
  /// @param options as the search has them, evaluator.replay among them @param line is cleared before a
  /// warning
  RunCheckpoint(std::string out, const IdentificationOptions& options, const Provenance& provenance,
                ProgressLine& line);

  /// For Evaluator::Options::progress.
  void AtEvaluation(const Progress& progress, const Evaluator& evaluator);

  /// For Evaluator::Options::watch.
  [[nodiscard]] EvaluatorWatch* watch() { return &watch_; }

  /// For StoppableWork: saves what the search has evaluated now. @return how to go on
  std::string SaveNow();

  /// A file that is resumed holds more than a search that still repeats it: it is not written again then.
  [[nodiscard]] bool IsBehind(std::size_t evaluations) const { return evaluations <= resumed_; }

 private:
  std::string out_;
  IdentificationOptions options_;
  Provenance provenance_;
  ProgressLine& line_;
  EvaluatorWatch watch_;
  std::size_t resumed_;  // evaluations of the file
  double next_saving_;
  bool unsaved_noted_ = false;
};

/// "; RUN.h5 holds its N evaluations: the same command with --resume goes on"
std::string HowToResume(const std::string& out, std::size_t evaluations);

}  // namespace sinew
