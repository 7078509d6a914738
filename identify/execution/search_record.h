// What is kept of the evaluations of a search: of all of them what resuming it needs, and of a bounded number
// the points.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include "base/constants.h"
#include "base/linear_algebra.h"
#include "identify/execution/failure_reasons.h"

namespace sinew {

/// One evaluation as it is kept in the run file.
struct TraceEntry {
  double seconds = 0;  ///< since the start of the run
  double cost = 0;     ///< infinite if the simulation failed there
  Vector x;
  std::string failure = {};  ///< why it failed, or was rejected; empty if it did not
  long evaluation = 0;       ///< its index in the record, from 0
  /// One of 2^level evaluations of the search that made it has this level or a higher one.
  int level = 0;
  bool stays = false;  ///< when others are left out, see SearchRecord
};

/// What is kept of every evaluation: a search that is resumed takes its cost from here if its point is the
/// same.
struct EvaluationOutcome {
  double cost = 0;           ///< infinite if it failed
  std::uint32_t mark = 0;    ///< SearchRecord::MarkOf its point
  std::int32_t reason = -1;  ///< of a failure, index in SearchRecord::reasons()
};

/// The record of a search, of bounded size.
///
/// It holds all evaluations up to `most_entries` (so many that their points have a million numbers, but
/// between 4096 and 65536). Beyond, it holds every second, every fourth, ... evaluation, so that at most
/// `most_entries` of these are left; besides, every one whose cost is lower by more than a thousandth than
/// that of the last one held for this reason (where there are constraints, also: of those that satisfy them),
/// the lowest, the first, and the first that failed. Which these are follows from the evaluations alone, and
/// appending what is left of another record is the same as appending all of it. So a resumed search has the
/// record of an uninterrupted one.
///
/// Outcomes are held of the first two million evaluations: a search that is resumed computes the others
/// again.
class SearchRecord {
 public:
  static constexpr long kMostOutcomes = 1L << 21;

  SearchRecord() = default;
  /// @param most_entries 0: as above
  explicit SearchRecord(long most_entries) : most_entries_(most_entries) {}
  /// Of all evaluations of a search, in their order.
  static SearchRecord OfAll(std::vector<TraceEntry> entries);
  /// What a file has. @param trace with numbers and levels @param outcomes of the first evaluations
  /// @param reasons messages of failures, to which the outcomes point
  static SearchRecord Restored(long evaluations, std::vector<TraceEntry> trace,
                               std::deque<EvaluationOutcome> outcomes, std::vector<std::string> reasons);

  /// The next evaluation; its number and level are set here. @param is_best the lowest that satisfies the
  /// constraints
  void Add(TraceEntry entry, bool is_best);
  /// The evaluations of another search. @param is_best [other.trace()] as of Add
  void Append(const SearchRecord& other, const std::vector<bool>& is_best);
  /// The evaluations from `first` on. @pre first + count <= recorded()
  [[nodiscard]] SearchRecord Part(long first, long count) const;

  [[nodiscard]] long evaluations() const { return evaluations_; }
  /// In the order of the evaluations.
  [[nodiscard]] const std::vector<TraceEntry>& trace() const { return trace_; }
  /// Whether the trace lacks evaluations.
  [[nodiscard]] bool thinned() const { return static_cast<long>(trace_.size()) < evaluations_; }
  [[nodiscard]] bool has_best() const { return best_ >= 0; }
  /// @pre has_best()
  [[nodiscard]] const TraceEntry& best() const { return trace_[static_cast<std::size_t>(best_)]; }

  /// Of the first evaluations, kMostOutcomes at most.
  [[nodiscard]] const std::deque<EvaluationOutcome>& outcomes() const { return outcomes_; }
  [[nodiscard]] long recorded() const { return static_cast<long>(outcomes_.size()); }
  /// The outcome of this evaluation; nullptr if it is not known, or is that of another point.
  [[nodiscard]] const EvaluationOutcome* Find(long evaluation, const Vector& x) const;
  /// Why it failed, in its own words where the trace has it, else in those of the first failure of its kind.
  /// @pre its outcome is known, and it failed
  [[nodiscard]] const std::string& FailureOf(long evaluation) const;
  [[nodiscard]] const FailureCounts& reasons() const { return reasons_; }

  /// A digest of the point, in 32 bits.
  [[nodiscard]] static std::uint32_t MarkOf(const Vector& x);
  /// @param evaluation index in the search that made it
  [[nodiscard]] static int LevelOf(long evaluation);

 private:
  void Count(long more, Eigen::Index variables);
  void Insert(TraceEntry entry, bool is_best);
  void Supersede(long& current, const long& other);
  void LeaveOut();
  [[nodiscard]] bool Stays(const TraceEntry& entry) const { return entry.stays || entry.level >= level_; }

  long most_entries_ = 0;
  long evaluations_ = 0;
  int level_ = 0;  // entries of a lower one are left out
  std::vector<TraceEntry> trace_;
  long lowest_ = -1;  // index in trace_
  long best_ = -1;    // the same
  // Costs of the last ones that stay because they are lower than those before them, and because they satisfy
  // the constraints, too.
  double lower_ = kInfinity;
  double better_ = kInfinity;
  bool failed_ = false;
  std::deque<EvaluationOutcome> outcomes_;
  FailureCounts reasons_;
};

}  // namespace sinew
