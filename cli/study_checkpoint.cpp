#include "cli/study_checkpoint.h"

#include <algorithm>
#include <cstdio>
#include <utility>

#include "base/hdf5_tree.h"

namespace sinew {
namespace {

constexpr std::chrono::seconds kStudyInterval{2};

}  // namespace

StudyCheckpoint::StudyCheckpoint(File file, const FitSetup& setup, const std::vector<StudyRun>& done)
    : file_(std::move(file)), resumed_(done.size()) {
  study_.free = setup.free;
  study_.finished = false;
  for (const StudyRun& run : done) Add(run);
}

void StudyCheckpoint::AtRun(const StudyRun& run) {
  const std::lock_guard lock(mutex_);
  Add(run);
  if (std::chrono::steady_clock::now() - saved_ < kStudyInterval) return;
  // A checkpoint that cannot be written is no reason to stop: the result itself may find room again.
  const Status saved = Write();
  if (!saved && !unsaved_noted_) {
    file_.line.Clear();
    Print(stderr,
          Wrapped("warning: this comparison continues without checkpoints: " + saved.error().message, 0));
  }
  unsaved_noted_ = !saved;
  saved_ = std::chrono::steady_clock::now();
}

std::string StudyCheckpoint::SaveNow() {
  const std::lock_guard lock(mutex_);
  if (study_.runs.empty()) return " before a run had ended: begin it again";
  const Status saved = study_.runs.size() > resumed_ ? Write() : Status();
  if (!saved) return ", and what was found is lost: " + saved.error().message;
  return HowToResume(file_.out, study_.runs.size());
}

std::string StudyCheckpoint::HowToResume(const std::string& out, std::size_t runs) {
  return fmt::format("; {} holds the {} run{} that had ended: the same command with --resume goes on", out,
                     runs, runs == 1 ? "" : "s");
}

void StudyCheckpoint::Add(const StudyRun& run) {
  if (run.stop.usable()) study_.best = std::min(study_.best, run.cost);
  study_.target = study_.best;
  study_.runs.push_back(run);
}

Status StudyCheckpoint::Write() {
  return WriteHdf5(file_.out, files::StudyTree(file_.problem, study_, file_.provenance, file_.origin));
}

}  // namespace sinew
