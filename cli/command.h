// The subcommands of the program, each in a file of its own, and how they declare their words. CLI11 stays
// behind this: its header costs seconds in every file that includes it.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "base/error.h"

namespace CLI {  // NOLINT(readability-identifier-naming): CLI11's
class App;
class Option;
}  // namespace CLI

namespace sinew {

struct Program;

/// Exit status: done; ran, but the answer is not usable; bad input or usage. That of a command that was
/// stopped is StopStatus() (stop_signals.h).
enum ExitStatus { kDone = 0, kNotUsable = 1, kBadInput = 2 };

/// Prints "PROGRAM: no usable answer: why" to standard error. @return kNotUsable
int ReportNotUsable(const Program& program, const std::string& why);

/// Prints "PROGRAM: stopped by SIGTERM: how to go on" to standard error. @return StopStatus()
int ReportStopped(const Program& program, const std::string& rest);

/// What a subcommand runs once its options are parsed. An Error means kBadInput.
using Action = std::function<Result<int>()>;

/// Adds a subcommand; `run` is called with its action if it was given on the command line.
using RunAction = std::function<void(Action)>;

/// A word of a command while it is declared.
class CommandWord {
 public:
  explicit CommandWord(CLI::Option* option) : option_(option) {}

  CommandWord& Required();
  /// What the help shows for its value.
  CommandWord& Shows(const std::string& type);
  /// Several values in one word, with `delimiter` between them.
  CommandWord& Split(char delimiter);
  /// The help shows the value that it has now.
  CommandWord& ShowsDefault();
  CommandWord& Between(int low, int high);
  /// @param type what the help shows; empty: the range.
  CommandWord& Between(std::uint64_t low, std::uint64_t high, const std::string& type = "");
  CommandWord& AtLeastZero();
  /// An empty word is an error.
  CommandWord& NotEmpty();

 private:
  CLI::Option* option_;
};

/// A command while it is declared. Whatever its words are read into must outlive the parsing.
class Command {
 public:
  Command(CLI::App& app, const Program& program) : app_(&app), program_(&program) {}

  /// The program that it belongs to.
  [[nodiscard]] const Program& program() const { return *program_; }

  Command AddCommand(const std::string& name, const std::string& meaning);
  /// One of its own commands must be given.
  void RequireCommand();

  /// T is a string, int, std::uint64_t, an optional long or double, or a vector of strings.
  /// @param name "--name", or "name" of a word that stands alone.
  template <class T>
  CommandWord Add(const std::string& name, T& value, const std::string& meaning = "");
  CommandWord AddFlag(const std::string& name, bool& value, const std::string& meaning);

  /// What it does, once it is parsed.
  void Runs(const RunAction& run, const Action& action);

 private:
  CLI::App* app_;
  const Program* program_;
};

void AddListCommand(Command app, const RunAction& run);
void AddDataCommand(Command app, const RunAction& run);
void AddSimulateCommand(Command app, const RunAction& run);
void AddIdentifyCommand(Command app, const RunAction& run);
void AddDiagnoseCommand(Command app, const RunAction& run);
void AddCompareCommand(Command app, const RunAction& run);
void AddReportCommand(Command app, const RunAction& run);
void AddCohortCommand(Command app, const RunAction& run);
void AddMbsCommand(Command app, const RunAction& run);

}  // namespace sinew
