#include <cmath>
#include <filesystem>

#include "base/numbers.h"
#include "base/printable.h"
#include "cli/cohort/summary.h"
#include "cli/terminal.h"

namespace sinew::cohort {
namespace {

constexpr const char* kStyle =
    "body{font:15px/1.45 system-ui,sans-serif;margin:2em auto;max-width:75em;padding:0 1em;color:#222}"
    "table{border-collapse:collapse;margin:.6em 0 1.6em}th,td{padding:.25em .7em;border-bottom:1px solid "
    "#ddd;"
    "text-align:left}td.n{text-align:right;font-variant-numeric:tabular-nums}th{border-bottom:2px solid #999}"
    ".failed{background:#f6d3d0}.notrun,.stopped{background:#f3ead0}.done{background:#dcefdc}.kept{color:#"
    "777}"
    ".weak,.at_bound,.not_identifiable{color:#a33}h1{font-size:1.5em}h2{font-size:1.15em;margin-top:1.6em}";

std::string Escaped(const std::string& text) {
  std::string html;
  for (const char c : PrintableLine(text)) {
    switch (c) {
      case '&':
        html += "&amp;";
        break;
      case '<':
        html += "&lt;";
        break;
      case '>':
        html += "&gt;";
        break;
      case '"':
        html += "&quot;";
        break;
      default:
        html += c;
    }
  }
  return html;
}

std::string NumberCell(double value) {
  return std::isnan(value) ? "&ndash;" : Escaped(Readable(value, 4));
}

std::string Cell(const std::string& html, const std::string& kind = "") {
  return kind.empty() ? "<td>" + html + "</td>" : "<td class=\"" + kind + "\">" + html + "</td>";
}

std::string Header(const std::vector<std::string>& names) {
  std::string html = "<tr>";
  for (const std::string& name : names) html += "<th>" + Escaped(name) + "</th>";
  return html + "</tr>\n";
}

class Page {
 public:
  explicit Page(const Summary& summary) : summary_(summary), pipeline_(*summary.pipeline) {}

  std::string Make() {
    html_ = "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>Cohort: " +
            Escaped(pipeline_.out) + "</title><style>" + kStyle +
            "</style></head><body>\n<h1>Cohort: " + Escaped(pipeline_.out) + "</h1>\n";
    html_ += fmt::format(
        "<p>{} subjects, {} steps: {} done, {} kept from before, {} failed, {} not run, {} "
        "stopped.</p>\n",
        pipeline_.subjects.size(), pipeline_.tasks.size(), summary_.CountOf(Outcome::kDone),
        summary_.CountOf(Outcome::kKept), summary_.CountOf(Outcome::kFailed),
        summary_.CountOf(Outcome::kNotRun), summary_.CountOf(Outcome::kStopped));
    Failures();
    Steps();
    Spreads();
    Counts("Verdicts of the diagnoses", "verdict", summary_.verdicts);
    Counts("Causes that are named", "cause", summary_.causes);
    Estimates();
    return html_ + "</body></html>\n";
  }

 private:
  // Relative to the folder in which the page stands.
  [[nodiscard]] std::string Link(const std::string& path, const std::string& text) const {
    const std::string target = std::filesystem::path(path).lexically_relative(pipeline_.out).string();
    if (path.empty() || target.empty() || target.rfind("..", 0) == 0) return Escaped(text);
    return "<a href=\"" + Escaped(target) + "\">" + Escaped(text) + "</a>";
  }

  void Failures() {
    if (summary_.CountOf(Outcome::kFailed) == 0) return;
    html_ += "<h2>Failures</h2>\n<table>" + Header({"subject", "step", "why"});
    for (std::size_t i = 0; i < pipeline_.tasks.size(); ++i) {
      const TaskResult& result = summary_.results[i];
      if (result.outcome != Outcome::kFailed) continue;
      html_ += "<tr>" + Cell(Escaped(pipeline_.tasks[i].subject)) +
               Cell(Link(result.log, pipeline_.tasks[i].step)) + Cell(Escaped(result.reason)) + "</tr>\n";
    }
    html_ += "</table>\n";
  }

  void Steps() {
    std::vector<std::string> names{"subject"};
    names.insert(names.end(), pipeline_.steps.begin(), pipeline_.steps.end());
    html_ +=
        "<h2>Steps</h2>\n<p>The time leads to what a step printed; the name of a page to that "
        "page.</p>\n<table>" +
        Header(names);
    for (const std::string& subject : pipeline_.subjects) {
      html_ += "<tr>" + Cell(Escaped(subject));
      for (const std::string& step : pipeline_.steps) {
        for (std::size_t i = 0; i < pipeline_.tasks.size(); ++i) {
          if (pipeline_.tasks[i].subject == subject && pipeline_.tasks[i].step == step) html_ += Step(i);
        }
      }
      html_ += "</tr>\n";
    }
    html_ += "</table>\n";
  }

  [[nodiscard]] std::string Step(std::size_t i) const {
    const TaskResult& result = summary_.results[i];
    const bool is_done = result.outcome == Outcome::kDone || result.outcome == Outcome::kKept;
    std::string text = Link(result.log, is_done ? Duration(result.seconds) : ToString(result.outcome));
    for (const std::string& path : pipeline_.tasks[i].written) {
      std::error_code code;
      if (is_done && std::filesystem::exists(pipeline_.Located(path + "/index.html"), code))
        text += " " + Link(path + "/index.html", "page");
    }
    std::string kind = ToString(result.outcome);
    if (result.outcome == Outcome::kNotRun) kind = "notrun";
    return Cell(text, kind);
  }

  void Spreads() {
    if (summary_.spreads.empty()) return;
    html_ += "<h2>Parameters over the subjects whose data determine them</h2>\n<table>" +
             Header({"parameter", "unit", "step", "identifiable", "median", "lowest", "highest"});
    for (const ParameterSpread& one : summary_.spreads)
      html_ += "<tr>" + Cell(Escaped(one.parameter)) + Cell(Escaped(one.unit)) + Cell(Escaped(one.step)) +
               Cell(fmt::format("{} of {}", one.identifiable, one.subjects), "n") +
               Cell(NumberCell(one.median), "n") + Cell(NumberCell(one.lowest), "n") +
               Cell(NumberCell(one.highest), "n") + "</tr>\n";
    html_ += "</table>\n";
  }

  void Counts(const char* title, const char* name, const std::vector<Counted>& counts) {
    if (counts.empty()) return;
    html_ += std::string("<h2>") + title + "</h2>\n<table>" + Header({name, "step", "subjects"});
    for (const Counted& one : counts)
      html_ += "<tr>" + Cell(Escaped(one.name)) + Cell(Escaped(one.step)) +
               Cell(std::to_string(one.subjects), "n") + "</tr>\n";
    html_ += "</table>\n";
  }

  void Estimates() {
    if (summary_.estimates.empty()) return;
    html_ += "<h2>Parameters of every subject</h2>\n<table>" +
             Header({"subject", "step", "parameter", "value", "95 % interval", "unit", "verdict"});
    for (const Estimate& one : summary_.estimates) {
      const bool has = !std::isnan(one.lower) && !std::isnan(one.upper);
      html_ += "<tr>" + Cell(Escaped(one.subject)) + Cell(Escaped(one.step)) + Cell(Escaped(one.parameter)) +
               Cell(NumberCell(one.value), "n") +
               Cell(has ? NumberCell(one.lower) + " to " + NumberCell(one.upper) : "none", "n") +
               Cell(Escaped(one.unit)) + Cell(Escaped(one.verdict), Escaped(one.verdict)) + "</tr>\n";
    }
    html_ += "</table>\n";
  }

  const Summary& summary_;
  const Pipeline& pipeline_;
  std::string html_;
};

}  // namespace

std::string SummaryPage(const Summary& summary) {
  return Page(summary).Make();
}

}  // namespace sinew::cohort
