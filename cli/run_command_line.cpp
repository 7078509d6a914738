// Parses the words of a command line, runs one command, and prints what is wrong.
#include "cli/run_command_line.h"

#include <fcntl.h>
#include <malloc.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <exception>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "base/printable.h"
#include "base/text.h"
#include "base/version.h"
#include "cli/command.h"
#include "cli/mpi_ranks.h"
#include "cli/parsed_words.h"
#include "cli/stop_signals.h"
#include "cli/terminal.h"

namespace sinew {
namespace {

// One line, without the newlines that a library or a file may put into a message.
int Refuse(const Program& program, std::string message) {
  while (!message.empty() && message.back() == '\n') message.pop_back();
  for (char& c : message) c = c == '\n' ? ' ' : c;
  Print(stderr, fmt::format("{}: error: {}\n", program.name, PrintableLine(message)));
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

// "--solvers ,", or empty if there is none. CLI11 drops empty names, and then takes the next option for one.
std::string ListWithoutName(const CLI::App& command, const std::vector<std::string>& words) {
  const auto without_name = [&](const std::string& option, const std::string& list) {
    const CLI::Option* known = command.get_option_no_throw(option);
    return known != nullptr && known->get_delimiter() != 0 && !list.empty() &&
           list.find_first_not_of(known->get_delimiter()) == std::string::npos;
  };
  for (std::size_t i = 0; i < words.size(); ++i) {
    const auto equals = words[i].find('=');
    std::string option = words[i].substr(0, equals);
    if (option.rfind("--", 0) != 0) continue;
    std::string list;
    if (equals != std::string::npos) {
      list = words[i].substr(equals + 1);
    } else if (i + 1 < words.size()) {
      list = words[i + 1];
    }
    if (without_name(option, list)) return option + " " + list;
  }
  return {};
}

// The command that the words name, and its own words in front of "--help".
const CLI::App* FindCommand(const CLI::App& app, const std::vector<std::string>& words, std::string& named) {
  const CLI::App* command = &app;
  for (const std::string& word : words) {
    const auto subcommands = command->get_subcommands(nullptr);
    const auto is = [&](const CLI::App* subcommand) { return subcommand->get_name() == word; };
    const auto found = std::find_if(subcommands.begin(), subcommands.end(), is);
    if (found == subcommands.end()) break;
    command = *found;
    named += " " + word;
  }
  return command;
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

// A standard stream that was closed (`>&-`) would give its number to the first file that is opened, and what
// is printed would land in it. With /dev/null for reading in its place, printing fails as it should.
void KeepStandardStreams() {
  for (int stream = STDIN_FILENO; stream <= STDERR_FILENO; ++stream) {
    if (fcntl(stream, F_GETFD) < 0 && errno == EBADF) static_cast<void>(open("/dev/null", O_RDONLY));
  }
}

// Predictions of some megabytes are made and freed thousands of times. By default the C library gives such
// memory back to the system each time, which then fills it with zeros again: a twelfth of the processor time
// of a diagnosis by two threads.
void KeepFreedMemory() {
#ifdef __GLIBC__
  mallopt(M_MMAP_THRESHOLD, 32 << 20);
  mallopt(M_TRIM_THRESHOLD, 256 << 20);
#endif
}

void AddCommands(CLI::App& app, const Program& program, const RunAction& run) {
  app.require_subcommand(1);
  const Command root(app, program);
  AddListCommand(root, run);
  AddDataCommand(root, run);
  AddSimulateCommand(root, run);
  AddIdentifyCommand(root, run);
  AddDiagnoseCommand(root, run);
  AddCompareCommand(root, run);
  AddReportCommand(root, run);
  AddCohortCommand(root, run);
  if (program.mechanisms) AddMbsCommand(root, run);
}

// "--solvers ,: expected names...", or empty if there is nothing to be said.
std::string WrongList(const Program& program, const CLI::App& app, const std::vector<std::string>& words) {
  std::string named = program.name;
  const std::string list = ListWithoutName(*FindCommand(app, words, named), words);
  return list.empty() ? "" : list + ": expected names, separated by commas (see " + named + " --help)";
}

// Of several processes all others leave these words to rank 0.
bool IsForRankZeroAlone(const CLI::App& app) {
  const std::string name = app.get_subcommands().empty() ? "" : app.get_subcommands().front()->get_name();
  return name != "identify" && name != "diagnose" && name != "compare" && name != "run";
}

int Run(int argc, char** argv, const Program& program) {
  CLI::App app(program.description);
  app.set_version_flag("--version", std::string("sinew ") + kVersion);
  app.set_help_all_flag("--help-all", "Help of every command");

  Action action;
  AddCommands(app, program, [&action](Action chosen) { action = std::move(chosen); });
  const std::vector<std::string> words(argv + std::min(argc, 1), argv + argc);
  if (const std::string wrong = WrongList(program, app, words); !wrong.empty()) return Refuse(program, wrong);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& success) {
    return app.exit(success);  // --help, --version
  } catch (const CLI::ParseError& error) {
    return Refuse(program, Explain(program, app, error));
  }
  if (IsHelper() && IsForRankZeroAlone(app)) return kDone;
  const Result<int> status = action();
  return status ? *status : Refuse(program, status.error().message);
}

}  // namespace

Result<ParsedWords> ParseWords(const Program& program, const std::vector<std::string>& words) {
  CLI::App app(program.description);
  AddCommands(app, program, [](const Action&) {});
  if (const std::string wrong = WrongList(program, app, words); !wrong.empty()) return Fail("{}", wrong);
  try {
    app.parse(std::vector<std::string>(words.rbegin(), words.rend()));  // CLI11 takes them from the back
  } catch (const CLI::Success&) {
    return Fail("{} asks for help only", Join(words, " "));
  } catch (const CLI::ParseError& error) {
    return Fail("{}", Explain(program, app, error));
  }
  ParsedWords parsed;
  const CLI::App* command = &app;
  while (!command->get_subcommands().empty()) {
    command = command->get_subcommands().front();
    parsed.command += (parsed.command.empty() ? "" : " ") + command->get_name();
  }
  for (const CLI::Option* option : command->get_options()) {
    for (const std::string& name : option->get_lnames()) {
      parsed.options.insert("--" + name);
      if (option->count() > 0) parsed.given.insert("--" + name);
    }
  }
  for (const char* name : {"--out", "--out-dir", "--json"}) {
    const CLI::Option* option = command->get_option_no_throw(name);
    if (option == nullptr || option->count() == 0 || option->get_items_expected_max() == 0) continue;
    for (const std::string& value : option->results()) {
      if (value != "-") parsed.written.push_back(value);
    }
  }
  return parsed;
}

int RunCommandLine(int argc, char** argv, const Program& program) {
  try {
    KeepStandardStreams();
    KeepFreedMemory();
    const StopSignals signals(program.name);
    std::unique_ptr<Ranks> ranks;
    if (StartedWithOthers()) {
      auto joined = JoinRanks();
      if (!joined) return Refuse(program, joined.error().message);
      ranks = std::move(*joined);
    }
    const int status = Run(argc, argv, program);
    // What was printed may have been waiting until now. Why an earlier part failed is not known any more.
    const bool flushed = std::fflush(stdout) == 0;
    const std::string why = flushed ? " (disk full?)" : std::string(": ") + std::strerror(errno);
    if ((flushed && std::ferror(stdout) == 0) || status == kBadInput) return status;
    const int refused = Refuse(program, "standard output cannot be written" + why);
    return status == kDone ? refused : status;
  } catch (const std::exception& exception) {
    return Refuse(program, std::string("unexpected: ") + exception.what());
  }
}

}  // namespace sinew
