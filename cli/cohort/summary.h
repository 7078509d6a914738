// What a cohort has come to: facts from the files that its steps have written.
#pragma once

#include <string>
#include <vector>

#include "cli/cohort/cohort_run.h"

namespace sinew::cohort {

/// A fitted parameter of one subject.
struct Estimate {
  std::string subject;
  std::string step;
  std::string parameter;
  std::string unit;
  double value = 0;
  double lower = 0;  ///< 95 % interval; NaN if there is none
  double upper = 0;
  std::string verdict;  ///< "identifiable", ... (docs/run_file.md)
};

struct SubjectDiagnosis {
  std::string subject;
  std::string step;
  std::string verdict;              ///< "adequate", "explained", "ambiguous", "unexplained"
  std::vector<std::string> causes;  ///< effects that it names
};

/// A parameter over all subjects whose data determine it.
struct ParameterSpread {
  std::string step;
  std::string parameter;
  std::string unit;
  int subjects = 0;      ///< in whose fit it is
  int identifiable = 0;  ///< of them
  double median = 0;     ///< of the identifiable ones; NaN if there is none
  double lowest = 0;
  double highest = 0;
};

struct Counted {
  std::string step;
  std::string name;
  int subjects = 0;
};

struct Summary {
  const Pipeline* pipeline = nullptr;
  std::vector<TaskResult> results;  ///< [tasks of the pipeline]
  std::vector<Estimate> estimates;
  std::vector<SubjectDiagnosis> diagnoses;
  std::vector<ParameterSpread> spreads;  ///< in the order of the steps and of the fits
  std::vector<Counted> verdicts;         ///< of diagnoses, most often first
  std::vector<Counted> causes;           ///< that are named, most often first

  [[nodiscard]] int CountOf(Outcome outcome) const;
};

/// Reads the run files of `identify` and `diagnose` that are there. One that cannot be read makes its task
/// one that failed.
[[nodiscard]] Summary Summarise(const Pipeline& pipeline, std::vector<TaskResult> results);

/// "done", "kept", "failed", "not run", "stopped"
[[nodiscard]] const char* ToString(Outcome outcome);

/// Tables for the terminal.
[[nodiscard]] std::string SummaryText(const Summary& summary);
/// One self-contained page; its links are relative to the cohort's folder.
[[nodiscard]] std::string SummaryPage(const Summary& summary);
/// Schema sinew.cohort/1 (docs/cohorts.md).
[[nodiscard]] std::string SummaryJson(const Summary& summary);

}  // namespace sinew::cohort
