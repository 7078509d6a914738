// Loops over independent pieces of work that threads and processes share: starts of a search, refits, folds,
// ends of profiles, runs of a comparison.
#pragma once

#include <cstddef>
#include <functional>

#include "base/digest.h"
#include "identify/execution/answer.h"
#include "identify/execution/executor.h"

namespace sinew {

class FitRecord;
class Ranks;
class WorkTimes;

/// Who does the work, besides the threads of this process.
struct SharedWork {
  Ranks* ranks = nullptr;      ///< may be null: this process alone
  WorkTimes* times = nullptr;  ///< gets the processor times of all pieces; may be null
};

/// Each piece is done by one process, the others take its answer: together they do the same as
/// `for (i) make(i)`. A loop within a piece is done by the process that does the piece.
/// @param question all that the pieces follow from and that may differ within one work
/// @param make does piece `index` as Executor::Work does, and returns its answer. Without other processes the
/// answer is not looked at.
/// @param take called in one thread at a time, also while others make pieces. @return false: the answer is
/// not sufficient, so that the piece has to be made here as well
void ForEachShared(const SharedWork& work, const Digest& question, int threads, std::size_t count,
                   const std::function<Answer(std::size_t index, std::size_t worker)>& make,
                   const std::function<bool(std::size_t index, const Answer& answer)>& take);

/// The same of pieces whose time goes into fits that the record keeps: what others have done is done once
/// more, and finds their fits in the record. @param record may be null: this process alone
void ForEachShared(const FitRecord* record, int threads, std::size_t count, const Executor::Work& work);

}  // namespace sinew
