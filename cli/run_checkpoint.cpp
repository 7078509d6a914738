#include "cli/run_checkpoint.h"

#include <algorithm>
#include <cstdio>
#include <mutex>
#include <utility>

#include "base/hdf5_tree.h"

namespace sinew {
namespace {

constexpr double kInterval = 2;  // [s] between savings of a run that goes on ...
constexpr double kShare = 20;  // ... but at least so many times what one saving takes: long traces are large

}  // namespace

RunCheckpoint::RunCheckpoint(std::string out, const IdentificationOptions& options,
                             const Provenance& provenance, ProgressLine& line)
    : out_(std::move(out)),
      options_(options),
      provenance_(provenance),
      line_(line),
      resumed_(options.evaluator.replay.size()),
      next_saving_(kInterval) {
  options_.evaluator.replay.clear();
  options_.evaluator.finished.clear();
}

void RunCheckpoint::AtEvaluation(const Progress& progress, const Evaluator& evaluator) {
  line_.Show(progress, options_.evaluator.budget);
  if (progress.seconds < next_saving_ || IsBehind(evaluator.trace().size())) return;
  const double began = evaluator.seconds();
  // A checkpoint that cannot be written is no reason to stop: the answer itself may find room again.
  const Status saved = WriteHdf5(out_, UnfinishedRunTree(evaluator.fit(), options_, provenance_, evaluator));
  if (!saved && !unsaved_noted_) {
    line_.Clear();
    Print(stderr, Wrapped("warning: this run continues without checkpoints: " + saved.error().message, 0));
  }
  unsaved_noted_ = !saved;
  const double ended = evaluator.seconds();
  next_saving_ = ended + std::max(kInterval, kShare * (ended - began));
}

std::string RunCheckpoint::SaveNow() {
  const std::lock_guard lock(watch_.mutex);
  const Evaluator* search = watch_.running;
  const std::size_t evaluations = search == nullptr ? 0 : search->trace().size();
  if (IsBehind(evaluations)) {
    if (resumed_ > 0) return HowToResume(out_, resumed_);
    return " before anything was evaluated: begin it again";
  }
  const Status saved = WriteHdf5(out_, UnfinishedRunTree(search->fit(), options_, provenance_, *search));
  if (!saved) return ", and what was found is lost: " + saved.error().message;
  return HowToResume(out_, evaluations);
}

std::string HowToResume(const std::string& out, std::size_t evaluations) {
  return fmt::format("; {} holds {} evaluation{}: the same command with --resume goes on", out, evaluations,
                     evaluations == 1 ? "" : "s");
}

}  // namespace sinew
