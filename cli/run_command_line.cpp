// Parses the words of a command line, runs one command, and prints what is wrong.
#include "cli/run_command_line.h"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>

#include "base/text.h"
#include "base/version.h"
#include "cli/command.h"

namespace sinew {
namespace {

// One line, without the newlines that a library or a file may put into a message.
int Refuse(const Program& program, std::string message) {
  while (!message.empty() && message.back() == '\n') message.pop_back();
  for (char& c : message) c = c == '\n' ? ' ' : c;
  std::fprintf(stderr, "%s: error: %s\n", program.name.c_str(), message.c_str());
  return kBadInput;
}

// "unknown option '--thrads'; did you mean '--threads'?": CLI11 reports which words it could not place, but
// does not say what was meant.
std::string Unplaced(const CLI::App& command, std::string word) {
  word = word.substr(0, word.find('='));
  std::vector<std::string> names;
  if (word.front() == '-') {
    for (const CLI::Option* option : command.get_options()) {
      for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    }
    return "unknown option '" + word + "'" + Suggestion(word, names);
  }
  for (const CLI::App* subcommand : command.get_subcommands(nullptr)) names.push_back(subcommand->get_name());
  if (names.empty()) return "unexpected argument '" + word + "'";
  return "unknown command '" + word + "'" + Suggestion(word, names);
}

std::string Explain(const Program& program, const CLI::App& app, const CLI::ParseError& error) {
  const CLI::App* command = &app;
  std::string words = program.name;
  while (!command->get_subcommands().empty()) {
    command = command->get_subcommands().front();
    words += " " + command->get_name();
  }
  const std::vector<std::string> unplaced = command->remaining();
  const bool about_words = dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr ||
                           dynamic_cast<const CLI::RequiredError*>(&error) != nullptr;
  const bool known = !about_words || unplaced.empty() || unplaced.front().empty();
  return (known ? std::string(error.what()) : Unplaced(*command, unplaced.front())) + " (see " + words +
         " --help)";
}

int Run(int argc, char** argv, const Program& program) {
  CLI::App app(program.description);
  app.set_version_flag("--version", std::string("sinew ") + kVersion);
  app.require_subcommand(1);
  app.set_help_all_flag("--help-all", "Help of every command");

  Action action;
  const RunAction run = [&action](Action chosen) { action = std::move(chosen); };
  const Command root(app, program);
  AddListCommand(root, run);
  AddDataCommand(root, run);
  AddSimulateCommand(root, run);
  AddIdentifyCommand(root, run);
  AddDiagnoseCommand(root, run);
  AddCompareCommand(root, run);
  AddReportCommand(root, run);
  if (program.mechanisms) AddMbsCommand(root, run);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& success) {
    return app.exit(success);  // --help, --version
  } catch (const CLI::ParseError& error) {
    return Refuse(program, Explain(program, app, error));
  }
  const Result<int> status = action();
  return status ? *status : Refuse(program, status.error().message);
}

}  // namespace

int RunCommandLine(int argc, char** argv, const Program& program) {
  try {
    const int status = Run(argc, argv, program);
    // What was printed may have been waiting until now.
    if (status != kDone || (std::fflush(stdout) == 0 && std::ferror(stdout) == 0)) return status;
    return Refuse(program, "standard output cannot be written (disk full?)");
  } catch (const std::exception& exception) {
    return Refuse(program, std::string("unexpected: ") + exception.what());
  }
}

}  // namespace sinew
