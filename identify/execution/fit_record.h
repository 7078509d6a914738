// Outcomes of fits by what they were asked, so that a diagnosis or an analysis of intervals that is resumed
// does not do again what was done, and processes that share it do each fit once.
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <mutex>
#include <optional>

#include "base/digest.h"
#include "identify/execution/answer.h"
#include "identify/execution/shared_loop.h"

namespace sinew {

/// Answers that follow from their question alone: the question is a digest of everything that the answer
/// depends on and that may differ within one work (free parameters and their bounds, roles and samples of the
/// trials, starts, tolerances). What is the same throughout, such as data and version, is checked where the
/// record is read. Every member but `after_keep` and `shared` may be used from several threads.
class FitRecord {
 public:
  using Answer = sinew::Answer;
  using Answers = std::map<Digest::Value, Answer>;

  FitRecord() = default;
  ~FitRecord();
  FitRecord(const FitRecord&) = delete;
  FitRecord& operator=(const FitRecord&) = delete;

  [[nodiscard]] std::optional<Answer> Find(const Digest& question) const;
  /// An answer that is there already stays. What is kept within a piece of a shared loop is told to the other
  /// processes.
  void Keep(const Digest& question, Answer answer);

  /// In the order of the questions' digests, which is the same whatever the order of the work.
  [[nodiscard]] Answers All() const;
  [[nodiscard]] std::size_t size() const;
  /// Takes over the answers of an earlier run, as they were read.
  void Restore(Answers answers);

  /// From now on shares its loops, and takes over the answers of the other processes.
  void Share(const SharedWork& work);
  /// after_keep, for answers that came from other processes since.
  void TellOfArrivals() const;

  /// Called after every Keep by the thread that did it. Set before the work begins.
  std::function<void()> after_keep;
  /// Of the loops whose fits this record keeps; set by Share.
  SharedWork shared;

 private:
  mutable std::mutex mutex_;
  Answers answers_;
};

}  // namespace sinew
