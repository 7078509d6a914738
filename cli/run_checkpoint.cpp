#include "cli/run_checkpoint.h"

#include <algorithm>
#include <cstdio>
#include <mutex>
#include <utility>

#include "base/hdf5_tree.h"

namespace sinew {
namespace {

constexpr std::chrono::seconds kInterval{2};  // between savings of a run that goes on ...
constexpr int kShare = 20;  // ... but at least so many times what one saving takes: long traces are large

}  // namespace

RunCheckpoint::RunCheckpoint(File file, long resumed_evaluations)
    : file_(std::move(file)),
      resumed_evaluations_(resumed_evaluations),
      resumed_fits_(file_.record.size()),
      next_saving_(Clock::now() + kInterval) {}

bool RunCheckpoint::IsBehind(long evaluations) const {
  if (evaluations != resumed_evaluations_) return evaluations < resumed_evaluations_;
  return file_.record.size() <= resumed_fits_;
}

void RunCheckpoint::SaveIfDue() {
  const std::unique_lock saving(saving_, std::try_to_lock);
  if (!saving.owns_lock() || Clock::now() < next_saving_) return;
  const std::lock_guard lock(watch_.mutex);
  if (watch_.running == nullptr || IsBehind(watch_.running->evaluations())) return;
  const auto began = Clock::now();
  // A checkpoint that cannot be written is no reason to stop: the answer itself may find room again.
  const Status saved = Write();
  if (!saved && !unsaved_noted_) {
    file_.line.Clear();
    Print(stderr, Wrapped("warning: this run continues without checkpoints: " + saved.error().message, 0));
  }
  unsaved_noted_ = !saved;
  const auto ended = Clock::now();
  next_saving_ = ended + std::max<Clock::duration>(kInterval, kShare * (ended - began));
}

std::string RunCheckpoint::SaveNow() {
  const std::lock_guard saving(saving_);
  const std::lock_guard lock(watch_.mutex);
  const Evaluator* search = watch_.running;
  const long evaluations = search == nullptr ? 0 : search->evaluations();
  if (IsBehind(evaluations)) {
    if (resumed_evaluations_ > 0) return HowToResume(resumed_evaluations_);
    return " before anything was evaluated: begin it again";
  }
  if (search == nullptr) return HowToResume(resumed_evaluations_);
  const Status saved = Write();
  if (!saved) return ", and what was found is lost: " + saved.error().message;
  return HowToResume(evaluations);
}

Status RunCheckpoint::Write() {
  const Evaluator& search = *watch_.running;
  Hdf5Node tree = UnfinishedRunTree(search.fit(), file_.solver, file_.seed, file_.provenance, search);
  if (file_.origin != nullptr) tree.At("origin") = *file_.origin;
  return WriteHdf5(file_.out, tree);
}

std::string RunCheckpoint::HowToResume(long evaluations) const {
  const std::size_t fits = file_.record.size();
  const std::string more = fits == 0 ? "" : fmt::format(" and {} fit{}", fits, fits == 1 ? "" : "s");
  return fmt::format("; {} holds {} evaluation{}{}: the same command with --resume goes on", file_.out,
                     evaluations, evaluations == 1 ? "" : "s", more);
}

}  // namespace sinew
