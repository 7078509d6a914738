// The subcommands of the program; each in a file of its own.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

#include "base/error.h"

namespace sinew {

/// Exit status: done; ran, but the answer is not usable; bad input or usage.
enum ExitStatus { kDone = 0, kNotUsable = 1, kBadInput = 2 };

/// What a subcommand runs once its options are parsed. An Error means kBadInput.
using Action = std::function<Result<int>()>;

/// Adds a subcommand; `run` is called with its action if it was given on the command line.
using RunAction = std::function<void(Action)>;

void AddListCommand(CLI::App& app, const RunAction& run);
void AddDataCommand(CLI::App& app, const RunAction& run);
void AddSimulateCommand(CLI::App& app, const RunAction& run);
void AddIdentifyCommand(CLI::App& app, const RunAction& run);
void AddDiagnoseCommand(CLI::App& app, const RunAction& run);
void AddCompareCommand(CLI::App& app, const RunAction& run);
void AddReportCommand(CLI::App& app, const RunAction& run);

}  // namespace sinew
