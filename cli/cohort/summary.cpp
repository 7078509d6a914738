#include "cli/cohort/summary.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/constants.h"
#include "base/hdf5_tree.h"
#include "identify/files/columns.h"

namespace sinew::cohort {
namespace {

using files::NumberColumn;
using files::TextColumn;

std::size_t CountOfNames(const Hdf5Node& node, const char* name) {
  const Hdf5Node* names = node.Find(name);
  return names == nullptr || names->texts() == nullptr ? 0 : names->texts()->size();
}

Status AddEstimates(const std::string& path, const Task& task, const Hdf5Node& root, Summary& summary) {
  const std::size_t fitted = CountOfNames(root, "uncertainty/name");
  const std::size_t all = CountOfNames(root, "parameters/name");
  const auto* name = TextColumn(root, "uncertainty/name", fitted);
  const auto* verdict = TextColumn(root, "uncertainty/verdict", fitted);
  const auto* lower = NumberColumn(root, "uncertainty/ci95_lower", fitted);
  const auto* upper = NumberColumn(root, "uncertainty/ci95_upper", fitted);
  const auto* known = TextColumn(root, "parameters/name", all);
  const auto* unit = TextColumn(root, "parameters/unit", all);
  const auto* value = NumberColumn(root, "parameters/value", all);
  if (name == nullptr || verdict == nullptr || lower == nullptr || upper == nullptr || known == nullptr ||
      unit == nullptr || value == nullptr)
    return Fail("{}: has no answer", path);
  for (std::size_t i = 0; i < fitted; ++i) {
    const auto at = std::find(known->begin(), known->end(), (*name)[i]);
    if (at == known->end()) continue;
    const auto p = static_cast<std::size_t>(at - known->begin());
    summary.estimates.push_back({task.subject, task.step, (*name)[i], (*unit)[p], (*value)[p], (*lower)[i],
                                 (*upper)[i], (*verdict)[i]});
  }
  return {};
}

Status AddDiagnosis(const std::string& path, const Task& task, const Hdf5Node& root, Summary& summary) {
  const Hdf5Node* node = root.Find("diagnosis");
  if (node == nullptr) return Fail("{}: is no finished diagnosis", path);
  SubjectDiagnosis found{task.subject, task.step, node->Text("verdict"), {}};
  const std::size_t count = CountOfNames(*node, "causes/effect");
  if (const auto* effects = TextColumn(*node, "causes/effect", count); effects != nullptr)
    found.causes = *effects;
  summary.diagnoses.push_back(std::move(found));
  return {};
}

Status AddFindings(const Pipeline& pipeline, const Task& task, Summary& summary) {
  for (const Words& words : task.commands) {
    const bool fits = words.front() == "identify";
    if (!fits && words.front() != "diagnose") continue;
    const auto out = std::find(words.begin(), words.end(), "--out");
    if (out == words.end() || out + 1 == words.end()) continue;  // "--out=FILE" is not looked into
    const std::string path = pipeline.Located(*(out + 1));
    SINEW_ASSIGN(const Hdf5Node root, ReadHdf5(path));
    SINEW_TRY(fits ? AddEstimates(path, task, root, summary) : AddDiagnosis(path, task, root, summary));
  }
  return {};
}

void AddSpreads(Summary& summary) {
  std::vector<std::vector<double>> values;
  for (const Estimate& one : summary.estimates) {
    const auto same = [&](const ParameterSpread& spread) {
      return spread.step == one.step && spread.parameter == one.parameter;
    };
    auto at = std::find_if(summary.spreads.begin(), summary.spreads.end(), same);
    if (at == summary.spreads.end()) {
      summary.spreads.push_back({one.step, one.parameter, one.unit, 0, 0, kNaN, kNaN, kNaN});
      values.emplace_back();
      at = summary.spreads.end() - 1;
    }
    ++at->subjects;
    if (one.verdict != "identifiable") continue;
    ++at->identifiable;
    values[static_cast<std::size_t>(at - summary.spreads.begin())].push_back(one.value);
  }
  for (std::size_t i = 0; i < values.size(); ++i) {
    std::vector<double>& of = values[i];
    if (of.empty()) continue;
    std::sort(of.begin(), of.end());
    const std::size_t half = of.size() / 2;
    summary.spreads[i].median = of.size() % 2 == 1 ? of[half] : 0.5 * (of[half - 1] + of[half]);
    summary.spreads[i].lowest = of.front();
    summary.spreads[i].highest = of.back();
  }
}

void Count(const std::string& step, const std::string& name, std::vector<Counted>& counts) {
  const auto same = [&](const Counted& one) { return one.step == step && one.name == name; };
  const auto at = std::find_if(counts.begin(), counts.end(), same);
  if (at == counts.end()) {
    counts.push_back({step, name, 1});
  } else {
    ++at->subjects;
  }
}

}  // namespace

int Summary::CountOf(Outcome outcome) const {
  return static_cast<int>(std::count_if(results.begin(), results.end(),
                                        [&](const TaskResult& one) { return one.outcome == outcome; }));
}

Summary Summarise(const Pipeline& pipeline, std::vector<TaskResult> results) {
  Summary summary;
  summary.pipeline = &pipeline;
  summary.results = std::move(results);
  for (std::size_t i = 0; i < pipeline.tasks.size(); ++i) {
    TaskResult& result = summary.results[i];
    if (result.outcome != Outcome::kDone && result.outcome != Outcome::kKept) continue;
    if (const Status added = AddFindings(pipeline, pipeline.tasks[i], summary); !added) {
      result.outcome = Outcome::kFailed;
      result.reason = added.error().message;
    }
  }
  AddSpreads(summary);
  for (const SubjectDiagnosis& one : summary.diagnoses) {
    Count(one.step, one.verdict, summary.verdicts);
    for (const std::string& cause : one.causes) Count(one.step, cause, summary.causes);
  }
  for (std::vector<Counted>* counts : {&summary.verdicts, &summary.causes})
    std::stable_sort(counts->begin(), counts->end(),
                     [](const Counted& a, const Counted& b) { return a.subjects > b.subjects; });
  return summary;
}

const char* ToString(Outcome outcome) {
  switch (outcome) {
    case Outcome::kDone:
      return "done";
    case Outcome::kKept:
      return "kept";
    case Outcome::kFailed:
      return "failed";
    case Outcome::kNotRun:
      return "not run";
    case Outcome::kStopped:
      return "stopped";
  }
  return "?";
}

}  // namespace sinew::cohort
