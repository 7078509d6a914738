// The run file of an identification or a diagnosis that is still going on.
#pragma once

#include <chrono>
#include <cstddef>
#include <mutex>
#include <string>

#include "cli/terminal.h"
#include "identify/files/run_file.h"

namespace sinew {

/// Evaluator::Options::most_kept of what is saved: 16 MB.
inline constexpr std::size_t kMostKept = std::size_t{1} << 21;

/// Saves a search, and the fits that follow it, every few seconds and whenever it is asked to.
class RunCheckpoint {
 public:
  /// What all its files have in common; the references outlive it.
  struct File {
    std::string out;
    std::string solver;
    std::uint64_t seed = 1;
    const Provenance& provenance;
    const Hdf5Node* origin = nullptr;  ///< written as /origin; may be null
    const FitRecord& record;
    ProgressLine& line;  ///< cleared before a warning
  };

  /// @param resumed_evaluations of the file that is resumed; its fits are in the record
  RunCheckpoint(File file, long resumed_evaluations);

  /// To be called after every evaluation of the search and every fit (FitRecord::after_keep).
  void SaveIfDue();

  /// For Evaluator::Options::watch.
  [[nodiscard]] EvaluatorWatch* watch() { return &watch_; }

  /// For StoppableWork: saves what there is now. @return how to go on
  std::string SaveNow();

  /// A file that is resumed holds more than a search that still repeats it: it is not written again then.
  [[nodiscard]] bool IsBehind(long evaluations) const;

  /// "; RUN.h5 holds its N evaluations: the same command with --resume goes on"
  [[nodiscard]] std::string HowToResume(long evaluations) const;

 private:
  using Clock = std::chrono::steady_clock;

  /// @pre watch_.mutex is held, and a search is running
  Status Write();

  File file_;
  EvaluatorWatch watch_;
  long resumed_evaluations_;
  std::size_t resumed_fits_;
  std::mutex saving_;  // locked before the watch
  Clock::time_point next_saving_;
  bool unsaved_noted_ = false;
};

}  // namespace sinew
