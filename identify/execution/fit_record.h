// Outcomes of fits by what they were asked, so that a diagnosis or an analysis of intervals that is resumed
// does not do again what was done.
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "base/digest.h"

namespace sinew {

/// Answers that follow from their question alone: the question is a digest of everything that the answer
/// depends on and that may differ within one work (free parameters and their bounds, roles and samples of the
/// trials, starts, tolerances). What is the same throughout, such as data and version, is checked where the
/// record is read. Every member but `after_keep` may be used from several threads.
class FitRecord {
 public:
  struct Answer {
    std::vector<double> numbers;
    std::string text;
  };
  using Answers = std::map<Digest::Value, Answer>;

  [[nodiscard]] std::optional<Answer> Find(const Digest& question) const;
  /// An answer that is there already stays.
  void Keep(const Digest& question, Answer answer);

  /// In the order of the questions' digests, which is the same whatever the order of the work.
  [[nodiscard]] Answers All() const;
  [[nodiscard]] std::size_t size() const;
  /// Takes over the answers of an earlier run, as they were read.
  void Restore(Answers answers);

  /// Called after every Keep by the thread that did it. Set before the work begins.
  std::function<void()> after_keep;

 private:
  mutable std::mutex mutex_;
  Answers answers_;
};

}  // namespace sinew
