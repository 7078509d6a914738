#include "identify/execution/search_record.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/digest.h"

namespace sinew {
namespace {

constexpr long kMostNumbers = 1L << 20;  // of an entry: its point, and what else it takes
constexpr long kNumbersBesides = 8;
constexpr long kFewestEntries = 1L << 12;
constexpr long kMostEntries = 1L << 16;
constexpr double kImprovement = 1e-3;

// Index of the entry of an evaluation in the trace, or where it would stand.
std::ptrdiff_t PlaceOf(const std::vector<TraceEntry>& trace, long evaluation) {
  return std::lower_bound(trace.begin(), trace.end(), evaluation,
                          [](const TraceEntry& entry, long at) { return entry.evaluation < at; }) -
         trace.begin();
}

}  // namespace

std::uint32_t SearchRecord::MarkOf(const Vector& x) {
  return static_cast<std::uint32_t>(
      Digest().Add(x.data(), static_cast<std::size_t>(x.size())).value().front());
}

int SearchRecord::LevelOf(long evaluation) {
  int level = 0;
  for (long number = evaluation + 1; number % 2 == 0; number /= 2) ++level;
  return level;
}

SearchRecord SearchRecord::OfAll(std::vector<TraceEntry> entries) {
  SearchRecord record;
  for (TraceEntry& entry : entries) record.Add(std::move(entry), false);
  return record;
}

SearchRecord SearchRecord::Restored(long evaluations, std::vector<TraceEntry> trace,
                                    std::deque<EvaluationOutcome> outcomes,
                                    std::vector<std::string> reasons) {
  SearchRecord record;
  record.evaluations_ = evaluations;
  record.trace_ = std::move(trace);
  record.outcomes_ = std::move(outcomes);
  record.reasons_ = FailureCounts(std::move(reasons));
  for (std::size_t i = 0; i < record.outcomes_.size(); ++i) {
    const std::int32_t reason = record.outcomes_[i].reason;
    if (reason >= 0) record.reasons_.Count(static_cast<std::size_t>(reason), i, 1);
  }
  return record;
}

void SearchRecord::Count(long more, Eigen::Index variables) {
  if (most_entries_ == 0)
    most_entries_ = std::clamp(kMostNumbers / (variables + kNumbersBesides), kFewestEntries, kMostEntries);
  evaluations_ += more;
  if ((evaluations_ >> level_) <= most_entries_) return;
  while ((evaluations_ >> level_) > most_entries_) ++level_;
  LeaveOut();
}

void SearchRecord::LeaveOut() {
  std::size_t left = 0;
  for (std::size_t i = 0; i < trace_.size(); ++i) {
    const bool is_lowest = static_cast<long>(i) == lowest_;
    const bool is_best = static_cast<long>(i) == best_;
    if (!is_lowest && !is_best && !Stays(trace_[i])) continue;
    if (is_lowest) lowest_ = static_cast<long>(left);
    if (is_best) best_ = static_cast<long>(left);
    if (left != i) trace_[left] = std::move(trace_[i]);
    ++left;
  }
  trace_.resize(left);
}

// The last entry takes the place of the one that was the lowest so far, which goes if nothing else keeps it.
void SearchRecord::Supersede(long& current, const long& other) {
  const long old = current;
  current = static_cast<long>(trace_.size()) - 1;
  if (old < 0 || old == other || Stays(trace_[static_cast<std::size_t>(old)])) return;
  trace_.erase(trace_.begin() + old);
  for (long* index : {&lowest_, &best_}) *index -= *index > old ? 1 : 0;
}

void SearchRecord::Insert(TraceEntry entry, bool is_best) {
  const bool is_lowest =
      lowest_ < 0 ? std::isfinite(entry.cost) : entry.cost < trace_[static_cast<std::size_t>(lowest_)].cost;
  const bool is_first_failure = !std::isfinite(entry.cost) && !std::exchange(failed_, true);
  entry.stays = entry.evaluation == 0 || is_first_failure;
  if (is_lowest && !(entry.cost >= (1 - kImprovement) * lower_)) {
    lower_ = entry.cost;
    entry.stays = true;
  }
  if (is_best && !(entry.cost >= (1 - kImprovement) * better_)) {
    better_ = entry.cost;
    entry.stays = true;
  }
  if (!is_lowest && !is_best && !Stays(entry)) return;
  trace_.push_back(std::move(entry));
  if (is_lowest) Supersede(lowest_, best_);
  if (is_best) Supersede(best_, lowest_);
}

void SearchRecord::Add(TraceEntry entry, bool is_best) {
  entry.evaluation = evaluations_;
  entry.level = LevelOf(evaluations_);
  EvaluationOutcome outcome{entry.cost, MarkOf(entry.x), -1};
  if (!entry.failure.empty() || !std::isfinite(entry.cost))
    outcome.reason = reasons_.Add(entry.failure, static_cast<std::size_t>(evaluations_));
  if (recorded() < kMostOutcomes) outcomes_.push_back(outcome);
  Count(1, entry.x.size());
  Insert(std::move(entry), is_best);
}

void SearchRecord::Append(const SearchRecord& other, const std::vector<bool>& is_best) {
  const long offset = evaluations_;
  const std::vector<std::int32_t> reason = reasons_.Append(other.reasons_, static_cast<std::size_t>(offset));
  // Without a gap: the evaluations of a search that has more than are held are not known beyond.
  if (recorded() == offset) {
    for (EvaluationOutcome outcome : other.outcomes_) {
      if (recorded() == kMostOutcomes) break;
      if (outcome.reason >= 0) outcome.reason = reason[static_cast<std::size_t>(outcome.reason)];
      outcomes_.push_back(outcome);
    }
  }
  Count(other.evaluations_, other.trace_.empty() ? 0 : other.trace_.front().x.size());
  for (std::size_t i = 0; i < other.trace_.size(); ++i) {
    TraceEntry entry = other.trace_[i];
    entry.evaluation += offset;
    Insert(std::move(entry), is_best[i]);
  }
}

SearchRecord SearchRecord::Part(long first, long count) const {
  std::vector<TraceEntry> trace(trace_.begin() + PlaceOf(trace_, first),
                                trace_.begin() + PlaceOf(trace_, first + count));
  for (TraceEntry& entry : trace) entry.evaluation -= first;
  std::vector<std::string> reasons;
  for (const FailureReason& reason : reasons_.all()) reasons.push_back(reason.message);
  return Restored(count, std::move(trace), {outcomes_.begin() + first, outcomes_.begin() + first + count},
                  std::move(reasons));
}

const EvaluationOutcome* SearchRecord::Find(long evaluation, const Vector& x) const {
  if (evaluation >= recorded()) return nullptr;
  const EvaluationOutcome& outcome = outcomes_[static_cast<std::size_t>(evaluation)];
  return outcome.mark == MarkOf(x) ? &outcome : nullptr;
}

const std::string& SearchRecord::FailureOf(long evaluation) const {
  const auto at = static_cast<std::size_t>(PlaceOf(trace_, evaluation));
  if (at < trace_.size() && trace_[at].evaluation == evaluation) return trace_[at].failure;
  return reasons_.all()[static_cast<std::size_t>(outcomes_[static_cast<std::size_t>(evaluation)].reason)]
      .message;
}

}  // namespace sinew
