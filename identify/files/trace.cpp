#include "identify/files/trace.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/numbers.h"
#include "base/text.h"
#include "identify/files/columns.h"

namespace sinew::files {
namespace {

constexpr double kMostEvaluations = 9e15;  // whole numbers beyond are not exact
constexpr double kHighestLevel = 62;

bool IsWhole(double number, double below) {
  return number >= 0 && number < below && number == std::floor(number);
}

void WriteOutcomes(const SearchRecord& record, Hdf5Node& node) {
  node.attributes["evaluations"] = std::int64_t{record.evaluations()};
  std::vector<double> cost, mark, failed, reason;
  cost.reserve(record.outcomes().size());
  mark.reserve(record.outcomes().size());
  for (const EvaluationOutcome& outcome : record.outcomes()) {
    if (outcome.reason >= 0) {
      failed.push_back(static_cast<double>(cost.size()));
      reason.push_back(outcome.reason);
    }
    cost.push_back(outcome.cost);
    mark.push_back(outcome.mark);
  }
  std::vector<std::string> reasons;
  for (const FailureReason& one : record.reasons().all()) reasons.push_back(one.message);
  node.At("cost").SetVector(std::move(cost));
  node.At("mark").SetVector(std::move(mark));
  node.At("failed").SetVector(std::move(failed));
  node.At("reason").SetVector(std::move(reason));
  node.At("reasons").data = std::move(reasons);
}

tl::unexpected<Error> DoNotBelong(const std::string& path) {
  return Fail("{}: /resume/outcomes and /trace do not belong together", path);
}

// Runs of earlier versions have none.
Status ReadFailures(const std::string& path, const Hdf5Node& node, std::vector<TraceEntry>& trace) {
  const Hdf5Node* reasons = node.Find("failures/reason");
  if (reasons == nullptr) return {};
  const std::size_t count = reasons->texts() == nullptr ? 0 : reasons->texts()->size();
  const auto* evaluation = NumberColumn(node, "failures/evaluation", count);
  if (reasons->texts() == nullptr || evaluation == nullptr)
    return Fail("{}: /trace/failures is not complete", path);
  for (std::size_t i = 0; i < count; ++i) {
    const double at = (*evaluation)[i];
    const auto found =
        std::lower_bound(trace.begin(), trace.end(), at, [](const TraceEntry& entry, double wanted) {
          return static_cast<double>(entry.evaluation) < wanted;
        });
    if (found == trace.end() || static_cast<double>(found->evaluation) != at)
      return Fail("{}: /trace/failures names an evaluation that is not there", path);
    found->failure = (*reasons->texts())[i];
  }
  return {};
}

// The numbers and levels of the evaluations.
Status ReadPlaces(const std::string& path, const Hdf5Node& node, std::vector<TraceEntry>& trace) {
  const auto* evaluation = NumberColumn(node, "evaluation", trace.size());
  const auto* level = NumberColumn(node, "level", trace.size());
  const bool has_none = node.Find("evaluation") == nullptr && node.Find("level") == nullptr;
  if (!has_none && (evaluation == nullptr || level == nullptr))
    return Fail("{}: /trace is not complete: expected evaluation [E] and level [E]", path);
  for (std::size_t i = 0; i < trace.size(); ++i) {
    const auto number = static_cast<long>(i);
    trace[i].evaluation = number;
    trace[i].level = SearchRecord::LevelOf(number);
    if (has_none) continue;
    const bool increases = i == 0 || (*evaluation)[i] > static_cast<double>(trace[i - 1].evaluation);
    if (!IsWhole((*evaluation)[i], kMostEvaluations) || !increases ||
        !IsWhole((*level)[i], kHighestLevel + 1))
      return Fail("{}: /trace: evaluation and level {} are no numbers of an evaluation and a level", path, i);
    trace[i].evaluation = static_cast<long>((*evaluation)[i]);
    trace[i].level = static_cast<int>((*level)[i]);
  }
  return {};
}

Result<SearchRecord> WithOutcomes(const std::string& path, const Hdf5Node& node,
                                  std::vector<TraceEntry> trace) {
  const double evaluations = node.Number("evaluations", -1);
  const Hdf5Node* costs = node.Find("cost");
  const Hdf5Node* failures = node.Find("failed");
  const Hdf5Node* reasons = node.Find("reasons");
  const bool complete = costs != nullptr && costs->array() != nullptr && failures != nullptr &&
                        failures->array() != nullptr && reasons != nullptr && reasons->texts() != nullptr;
  const std::size_t count = complete ? costs->array()->values.size() : 0;
  const std::size_t failed = complete ? failures->array()->values.size() : 0;
  const auto* mark = NumberColumn(node, "mark", count);
  const auto* reason = NumberColumn(node, "reason", failed);
  if (!complete || mark == nullptr || reason == nullptr)
    return Fail("{}: /resume/outcomes is not complete", path);
  if (!IsWhole(evaluations, kMostEvaluations) || static_cast<double>(count) > evaluations ||
      (!trace.empty() && static_cast<double>(trace.back().evaluation) >= evaluations) ||
      reasons->texts()->size() > FailureCounts::kMostReasons)
    return DoNotBelong(path);
  std::deque<EvaluationOutcome> outcomes;
  double lowest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < count; ++i) {
    const double cost = costs->array()->values[i];
    if (!IsWhole((*mark)[i], 4294967296.0) || std::isnan(cost)) return DoNotBelong(path);
    outcomes.push_back({cost, static_cast<std::uint32_t>((*mark)[i]), -1});
    lowest = std::min(lowest, cost);
  }
  for (std::size_t i = 0; i < failed; ++i) {
    const double at = failures->array()->values[i];
    if (!IsWhole(at, static_cast<double>(count)) ||
        !IsWhole((*reason)[i], static_cast<double>(reasons->texts()->size())))
      return DoNotBelong(path);
    outcomes[static_cast<std::size_t>(at)].reason = static_cast<std::int32_t>((*reason)[i]);
  }
  for (const EvaluationOutcome& outcome : outcomes) {
    if (!std::isfinite(outcome.cost) && outcome.reason < 0) return DoNotBelong(path);
  }
  // A lower cost than that of the best point, which is looked at, would be taken for granted.
  const bool has_lowest =
      std::isinf(lowest) ||
      std::any_of(trace.begin(), trace.end(), [&](const TraceEntry& entry) { return entry.cost <= lowest; });
  if (!has_lowest) return DoNotBelong(path);
  return SearchRecord::Restored(static_cast<long>(evaluations), std::move(trace), std::move(outcomes),
                                *reasons->texts());
}

Result<SearchRecord> RecordOf(const std::string& path, const Hdf5Node& root, std::vector<TraceEntry> trace) {
  if (const Hdf5Node* outcomes = root.Find("resume/outcomes"); outcomes != nullptr)
    return WithOutcomes(path, *outcomes, std::move(trace));
  std::deque<EvaluationOutcome> outcomes;
  FailureCounts reasons;
  for (std::size_t i = 0; i < trace.size(); ++i) {
    const TraceEntry& entry = trace[i];
    if (entry.evaluation != static_cast<long>(i)) return DoNotBelong(path);
    if (i >= static_cast<std::size_t>(SearchRecord::kMostOutcomes)) break;
    outcomes.push_back({entry.cost, SearchRecord::MarkOf(entry.x), -1});
    if (!std::isfinite(entry.cost)) outcomes.back().reason = reasons.Add(entry.failure, i);
  }
  std::vector<std::string> messages;
  for (const FailureReason& reason : reasons.all()) messages.push_back(reason.message);
  const auto count = static_cast<long>(trace.size());
  return SearchRecord::Restored(count, std::move(trace), std::move(outcomes), std::move(messages));
}

}  // namespace

void WriteTrace(const SearchRecord& record, const std::vector<std::string>& variables, Hdf5Node& root) {
  std::vector<double> evaluation, level, seconds, cost, x, failed;
  std::vector<std::string> reason;
  for (auto* column : {&evaluation, &level, &seconds, &cost}) column->reserve(record.trace().size());
  x.reserve(record.trace().size() * variables.size());
  for (const TraceEntry& entry : record.trace()) {
    evaluation.push_back(static_cast<double>(entry.evaluation));
    level.push_back(entry.level);
    seconds.push_back(entry.seconds);
    cost.push_back(entry.cost);
    x.insert(x.end(), entry.x.data(), entry.x.data() + entry.x.size());
    if (entry.failure.empty()) continue;
    failed.push_back(static_cast<double>(entry.evaluation));
    reason.push_back(entry.failure);
  }
  Hdf5Node& node = root.At("trace");
  node.attributes["variables"] = Join(variables, ",");
  node.At("evaluation").SetVector(std::move(evaluation));
  node.At("level").SetVector(std::move(level));
  node.At("seconds").SetVector(std::move(seconds));
  node.At("cost").SetVector(std::move(cost));
  node.At("x").SetMatrix(record.trace().size(), variables.size(), std::move(x));
  if (!failed.empty()) {
    node.At("failures/evaluation").SetVector(std::move(failed));
    node.At("failures/reason").data = std::move(reason);
  }
  if (record.thinned()) WriteOutcomes(record, root.At("resume/outcomes"));
}

Result<RecordedTrace> ReadTrace(const std::string& path, const Hdf5Node& root) {
  const Hdf5Node* node = root.Find("trace");
  const Hdf5Node* cost = root.Find("trace/cost");
  const Hdf5Node* seconds = root.Find("trace/seconds");
  const Hdf5Node* x = root.Find("trace/x");
  if (node == nullptr || cost == nullptr || seconds == nullptr || x == nullptr || cost->array() == nullptr ||
      seconds->array() == nullptr || x->array() == nullptr || x->array()->shape.size() != 2 ||
      x->array()->shape[0] != cost->array()->values.size() ||
      seconds->array()->values.size() != cost->array()->values.size()) {
    return Fail("{}: /trace is not complete: expected seconds [E], cost [E] and x [E, n]", path);
  }
  RecordedTrace recorded;
  const std::string variables = node->Text("variables");  // Split returns views into it
  for (const auto name : Split(variables, ',')) {
    if (!name.empty()) recorded.variables.emplace_back(name);
  }
  const std::size_t columns = x->array()->shape[1];
  if (columns != recorded.variables.size()) {
    return Fail("{}: /trace/x has {} columns but names {} variables", path, columns,
                recorded.variables.size());
  }
  std::vector<TraceEntry> trace;
  trace.reserve(cost->array()->values.size());
  for (std::size_t i = 0; i < cost->array()->values.size(); ++i) {
    const double* row = x->array()->values.data() + i * columns;
    trace.push_back({seconds->array()->values[i], cost->array()->values[i],
                     Eigen::Map<const Vector>(row, static_cast<Eigen::Index>(columns))});
  }
  SINEW_TRY(ReadPlaces(path, *node, trace));
  SINEW_TRY(ReadFailures(path, *node, trace));
  SINEW_ASSIGN(recorded.record, RecordOf(path, root, std::move(trace)));
  return recorded;
}

}  // namespace sinew::files
