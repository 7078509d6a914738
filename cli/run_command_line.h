// The whole program for problems of one's own: identify, diagnose, compare, simulate, report, list and data.
//
//   int main(int argc, char** argv) { return sinew::RunCommandLine<Tank>(argc, argv, "tank"); }
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "problems/own_model.h"
#include "problems/registry.h"

namespace sinew {

/// What a program is called and what it can work on.
struct Program {
  std::string name;         ///< stands in front of its errors
  std::string description;  ///< first lines of --help
  std::vector<ProblemEntry> problems;
  bool mechanisms = false;    ///< has the command mbs too
  std::string report_folder;  ///< with sinew_report.py, if not share/sinew/report beside the program
};

/// Parses, runs one command and prints. With a single problem the word PROBLEM may be left out.
/// @return exit status: 0 done; 1 ran, but the answer is not usable; 2 bad input or usage
int RunCommandLine(int argc, char** argv, const Program& program);

/// The installed report; empty in the build tree, which names its own.
inline std::string InstalledReportFolder() {
#ifdef SINEW_INSTALLED_REPORT
  return SINEW_INSTALLED_REPORT;
#else
  return {};
#endif
}

/// @param problems made by ModelEntry<P>(name, sentence), or from ProblemRegistry()
inline int RunCommandLine(int argc, char** argv, std::vector<ProblemEntry> problems) {
  Program program;
  program.name = problems.size() == 1 ? problems.front().name : "sinew";
  program.description =
      "Identifies parameters from measured data and says what the fitted model still gets wrong.";
  program.problems = std::move(problems);
  program.report_folder = InstalledReportFolder();
  return RunCommandLine(argc, argv, program);
}

/// One model: see BindModel for what P must be.
template <class P>
int RunCommandLine(int argc, char** argv, const std::string& name) {
  return RunCommandLine(argc, argv, std::vector<ProblemEntry>{ModelEntry<P>(name)});
}

}  // namespace sinew
