#include "cli/command.h"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <optional>
#include <vector>

#include "base/printable.h"
#include "base/text.h"
#include "cli/run_command_line.h"
#include "cli/stop_signals.h"
#include "cli/terminal.h"

namespace sinew {

int ReportNotUsable(const Program& program, const std::string& why) {
  Print(stderr, fmt::format("{}: no usable answer: {}\n", program.name, PrintableLine(why)));
  return kNotUsable;
}

int ReportStopped(const Program& program, const std::string& rest) {
  Print(stderr, fmt::format("{}: stopped by {}{}\n", program.name, StopName(), PrintableLine(rest)));
  return StopStatus();
}

CommandWord& CommandWord::Required() {
  option_->required();
  return *this;
}

CommandWord& CommandWord::Shows(const std::string& type) {
  option_->type_name(type);
  return *this;
}

CommandWord& CommandWord::Split(char delimiter) {
  option_->delimiter(delimiter);
  return *this;
}

CommandWord& CommandWord::ShowsDefault() {
  option_->capture_default_str();
  return *this;
}

CommandWord& CommandWord::Between(int low, int high) {
  option_->check(CLI::Range(low, high));
  return *this;
}

CommandWord& CommandWord::Between(std::uint64_t low, std::uint64_t high, const std::string& type) {
  option_->check(CLI::Range(low, high, type));
  return *this;
}

CommandWord& CommandWord::AtLeastZero() {
  // CLI11's own check states the largest number in full, with 309 digits.
  option_->check(CLI::Validator(
      [](const std::string& word) {
        const auto number = ParseNumber(word);
        return number && *number >= 0 ? std::string() : "'" + word + "' is not a number of at least 0";
      },
      "NUMBER"));
  return *this;
}

CommandWord& CommandWord::NotEmpty() {
  option_->check(CLI::Validator(
      [](const std::string& word) {
        return word.empty() ? std::string("expected a name, not an empty word") : std::string();
      },
      ""));
  return *this;
}

Command Command::AddCommand(const std::string& name, const std::string& meaning) {
  return {*app_->add_subcommand(name, meaning), *program_};
}

void Command::RequireCommand() {
  app_->require_subcommand(1);
}

template <class T>
CommandWord Command::Add(const std::string& name, T& value, const std::string& meaning) {
  return CommandWord(app_->add_option(name, value, meaning));
}

template CommandWord Command::Add(const std::string&, std::string&, const std::string&);
template CommandWord Command::Add(const std::string&, int&, const std::string&);
template CommandWord Command::Add(const std::string&, std::uint64_t&, const std::string&);
template CommandWord Command::Add(const std::string&, std::optional<long>&, const std::string&);
template CommandWord Command::Add(const std::string&, std::optional<double>&, const std::string&);
template CommandWord Command::Add(const std::string&, std::vector<std::string>&, const std::string&);

CommandWord Command::AddFlag(const std::string& name, bool& value, const std::string& meaning) {
  return CommandWord(app_->add_flag(name, value, meaning));
}

void Command::Runs(const RunAction& run, const Action& action) {
  app_->callback([=] { run(action); });
}

}  // namespace sinew
