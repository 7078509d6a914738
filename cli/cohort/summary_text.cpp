#include <cmath>

#include "base/numbers.h"
#include "base/text.h"
#include "cli/cohort/summary.h"
#include "cli/terminal.h"

namespace sinew::cohort {
namespace {

constexpr std::size_t kMostSubjects = 50;  // that are shown if all is well

std::string Shown(double value) {
  return std::isnan(value) ? "-" : Readable(value, 4);
}

// One row per subject, one column per step.
std::string StepTable(const Summary& summary) {
  const Pipeline& pipeline = *summary.pipeline;
  std::vector<std::vector<std::string>> rows{{"subject"}};
  rows[0].insert(rows[0].end(), pipeline.steps.begin(), pipeline.steps.end());
  std::size_t left_out = 0;
  for (const std::string& subject : pipeline.subjects) {
    std::vector<std::string> row{subject};
    bool all_well = true;
    for (const std::string& step : pipeline.steps) {
      for (std::size_t i = 0; i < pipeline.tasks.size(); ++i) {
        if (pipeline.tasks[i].subject != subject || pipeline.tasks[i].step != step) continue;
        const TaskResult& result = summary.results[i];
        all_well = all_well && (result.outcome == Outcome::kDone || result.outcome == Outcome::kKept);
        row.push_back(result.outcome == Outcome::kDone ? Duration(result.seconds)
                                                       : std::string(ToString(result.outcome)));
      }
    }
    if (all_well && pipeline.subjects.size() > kMostSubjects) {
      ++left_out;
    } else {
      rows.push_back(std::move(row));
    }
  }
  std::string text = rows.size() > 1 ? Table(rows, 2) : "";
  if (left_out > 0) text += fmt::format("  {} subjects without a failure are not shown\n", left_out);
  return text;
}

std::string Counts(const char* title, const std::vector<Counted>& counts) {
  if (counts.empty()) return {};
  std::vector<std::vector<std::string>> rows{{title, "step", "subjects"}};
  for (const Counted& one : counts) rows.push_back({one.name, one.step, std::to_string(one.subjects)});
  return Table(rows, 2);
}

}  // namespace

std::string SummaryText(const Summary& summary) {
  const Pipeline& pipeline = *summary.pipeline;
  std::string text =
      fmt::format("run: {} subjects, {} steps: {} done, {} kept", pipeline.subjects.size(),
                  pipeline.tasks.size(), summary.CountOf(Outcome::kDone), summary.CountOf(Outcome::kKept));
  for (const Outcome other : {Outcome::kFailed, Outcome::kNotRun, Outcome::kStopped}) {
    if (summary.CountOf(other) > 0) text += fmt::format(", {} {}", summary.CountOf(other), ToString(other));
  }
  text += "\n" + StepTable(summary);
  if (!summary.spreads.empty()) {
    std::vector<std::vector<std::string>> rows{
        {"parameter", "unit", "step", "identifiable", "median", "lowest", "highest"}};
    for (const ParameterSpread& one : summary.spreads)
      rows.push_back({one.parameter, one.unit, one.step, fmt::format("{}/{}", one.identifiable, one.subjects),
                      Shown(one.median), Shown(one.lowest), Shown(one.highest)});
    text += Table(rows, 2);
  }
  text += Counts("verdict", summary.verdicts) + Counts("cause", summary.causes);
  for (std::size_t i = 0; i < summary.results.size(); ++i) {
    if (summary.results[i].outcome != Outcome::kFailed) continue;
    text += Wrapped(fmt::format("failed: {} of {}: {}", pipeline.tasks[i].step, pipeline.tasks[i].subject,
                                summary.results[i].reason),
                    2);
  }
  return text;
}

}  // namespace sinew::cohort
