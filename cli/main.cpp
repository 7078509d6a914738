// The sinew program: parses, calls, prints.
#include <cstdio>
#include <exception>

#include "base/version.h"
#include "cli/command.h"

namespace {

int Fail(const std::string& message) {
  std::fprintf(stderr, "sinew: error: %s\n", message.c_str());
  return sinew::kBadInput;
}

// One line, without the newlines that a library may put into its message.
std::string OneLine(std::string text) {
  while (!text.empty() && text.back() == '\n') text.pop_back();
  for (char& c : text) c = c == '\n' ? ' ' : c;
  return text;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "sinew identifies the parameters of human-robot interaction models from measured data,\n"
      "and says which of them the data cannot determine.");
  app.set_version_flag("--version", std::string("sinew ") + sinew::kVersion);
  app.require_subcommand(1);
  app.set_help_all_flag("--help-all", "Help of every command");

  sinew::Action action;
  const sinew::RunAction run = [&action](sinew::Action chosen) { action = std::move(chosen); };
  sinew::AddListCommand(app, run);
  sinew::AddDataCommand(app, run);
  sinew::AddSimulateCommand(app, run);
  sinew::AddIdentifyCommand(app, run);
  sinew::AddCompareCommand(app, run);
  sinew::AddReportCommand(app, run);

  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& success) {
    return app.exit(success);  // --help, --version
  } catch (const CLI::ParseError& error) {
    return Fail(OneLine(error.what()) + " (see sinew --help)");
  }
  try {
    const sinew::Result<int> status = action();
    return status ? *status : Fail(status.error().message);
  } catch (const std::exception& exception) {
    return Fail(std::string("unexpected: ") + exception.what());
  }
}
