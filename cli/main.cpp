// The sinew program: parses, calls, prints.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>

#include "base/text.h"
#include "base/version.h"
#include "cli/command.h"

namespace {

// One line, without the newlines that a library or a file may put into a message.
int Fail(std::string message) {
  while (!message.empty() && message.back() == '\n') message.pop_back();
  for (char& c : message) c = c == '\n' ? ' ' : c;
  std::fprintf(stderr, "sinew: error: %s\n", message.c_str());
  return sinew::kBadInput;
}

// "unknown option '--thrads'; did you mean '--threads'?": CLI11 knows which words it could not place, but
// does not say what was meant.
std::string Unplaced(const CLI::App& command, std::string word) {
  word = word.substr(0, word.find('='));
  std::vector<std::string> names;
  if (word.front() == '-') {
    for (const CLI::Option* option : command.get_options()) {
      for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    }
    return "unknown option '" + word + "'" + sinew::Suggestion(word, names);
  }
  for (const CLI::App* subcommand : command.get_subcommands(nullptr)) names.push_back(subcommand->get_name());
  if (names.empty()) return "the word '" + word + "' is one too many";
  return "unknown command '" + word + "'" + sinew::Suggestion(word, names);
}

std::string Explain(const CLI::App& app, const CLI::ParseError& error) {
  const CLI::App* command = &app;
  std::string words = "sinew";
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

int Run(int argc, char** argv) {
  CLI::App app(
      "sinew identifies the parameters of human-robot interaction models from measured data,\n"
      "says which of them the data cannot determine, and what the fitted model still gets wrong.");
  app.set_version_flag("--version", std::string("sinew ") + sinew::kVersion);
  app.require_subcommand(1);
  app.set_help_all_flag("--help-all", "Help of every command");

  sinew::Action action;
  const sinew::RunAction run = [&action](sinew::Action chosen) { action = std::move(chosen); };
  sinew::AddListCommand(app, run);
  sinew::AddDataCommand(app, run);
  sinew::AddSimulateCommand(app, run);
  sinew::AddIdentifyCommand(app, run);
  sinew::AddDiagnoseCommand(app, run);
  sinew::AddCompareCommand(app, run);
  sinew::AddReportCommand(app, run);
  sinew::AddMbsCommand(app, run);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& success) {
    return app.exit(success);  // --help, --version
  } catch (const CLI::ParseError& error) {
    return Fail(Explain(app, error));
  }
  const sinew::Result<int> status = action();
  return status ? *status : Fail(status.error().message);
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const int status = Run(argc, argv);
    // What was printed may have been waiting until now.
    if (status != sinew::kDone || (std::fflush(stdout) == 0 && std::ferror(stdout) == 0)) return status;
    return Fail("standard output cannot be written (disk full?)");
  } catch (const std::exception& exception) {
    std::fprintf(stderr, "sinew: error: unexpected: %s\n", exception.what());
    return sinew::kBadInput;
  }
}
