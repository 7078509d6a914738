// The study file of a comparison that is still going on.
#pragma once

#include <chrono>
#include <cstddef>
#include <mutex>
#include <string>
#include <vector>

#include "cli/terminal.h"
#include "identify/files/study_file.h"

namespace sinew {

/// Keeps every run that has ended, and saves them every few seconds and whenever it is asked to.
class StudyCheckpoint {
 public:
  /// What all its files have in common; the references outlive it.
  struct File {
    std::string out;
    const Problem& problem;
    const Provenance& provenance;
    const Hdf5Node& origin;
    ProgressLine& line;  ///< cleared before a warning
  };

  /// @param done runs of the file that is resumed
  StudyCheckpoint(File file, const FitSetup& setup, const std::vector<StudyRun>& done);

  /// For StudyOptions::after_run.
  void AtRun(const StudyRun& run);

  /// For StoppableWork. @return how to go on
  std::string SaveNow();

  /// "; STUDY.h5 holds the N runs that had ended: the same command with --resume goes on"
  static std::string HowToResume(const std::string& out, std::size_t runs);

 private:
  void Add(const StudyRun& run);
  Status Write();

  File file_;
  std::mutex mutex_;
  Study study_;
  std::size_t resumed_;
  std::chrono::steady_clock::time_point saved_ = std::chrono::steady_clock::now();
  bool unsaved_noted_ = false;
};

}  // namespace sinew
