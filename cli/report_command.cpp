// sinew report: hands run files to the report's own program (cli/report, Python), which executes a notebook.
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <filesystem>

#include "base/held_file.h"
#include "cli/command.h"
#include "cli/run_command_line.h"
#include "cli/stop_signals.h"
#include "cli/work_options.h"

namespace sinew {
namespace {

namespace fs = std::filesystem;

// Debian's own interpreter, whose packages packages.txt names; another python may come first on PATH.
constexpr const char* kPython = "/usr/bin/python3";

// Beside an installed program, else where its makers say, else in the source tree that it was built from.
Result<std::string> FindScript(const std::string& named) {
  std::error_code code;
  const fs::path program = fs::read_symlink("/proc/self/exe", code);
  for (const fs::path& folder : {program.parent_path().parent_path() / "share/sinew/report", fs::path(named),
                                 fs::path(SINEW_REPORT_SOURCE)}) {
    const fs::path script = folder / "sinew_report.py";
    if (!folder.empty() && fs::exists(script, code)) return script.string();
  }
  return Fail(
      "the report's program is not installed: expected share/sinew/report/sinew_report.py beside the "
      "program");
}

Result<int> RunReport(const std::string& folder, const std::vector<std::string>& files,
                      const std::string& out_dir, int threads) {
  SINEW_ASSIGN(const std::string script, FindScript(folder));
  RemoveAbandonedFiles(out_dir);  // those of an earlier report that was killed
  std::vector<std::string> words{kPython, script};
  words.insert(words.end(), files.begin(), files.end());
  words.insert(words.end(), {"--out-dir", out_dir, "--threads", std::to_string(threads)});
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);

  // The child, which has both signals blocked and asks for them, says what became of it: we wait for that.
  std::atomic<pid_t> child{0};
  const auto pass_on = [&child](int signal) {
    if (child > 0) kill(child, signal);
  };
  StoppableWork work([] { return std::string(); }, pass_on);
  work.Finish();
  setenv("SINEW_REPORT_PARENT", std::to_string(getpid()).c_str(), 1);  // NOLINT(concurrency-mt-unsafe)
  child = fork();
  if (child < 0) return Fail("cannot start {}", kPython);
  if (child == 0) {
    prctl(PR_SET_PDEATHSIG, SIGTERM);  // it writes nothing after this process was killed
    execv(kPython, arguments.data());
    _exit(127);
  }
  if (StopStatus() != 0) pass_on(StopStatus() - 128);  // it came before there was a child
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (!WIFEXITED(status)) return Fail("{} ended by signal {}", script, WTERMSIG(status));
  if (WEXITSTATUS(status) == 127)
    return Fail("{} is not there: install the packages of packages.txt", kPython);
  return WEXITSTATUS(status);
}

}  // namespace

void AddReportCommand(Command app, const RunAction& run) {
  auto files = std::make_shared<std::vector<std::string>>();
  auto out_dir = std::make_shared<std::string>();
  Command command = app.AddCommand(
      "report", "An executed notebook and a self-contained HTML page of runs, diagnoses and studies");
  command.Add("files", *files, "Run, diagnosis or study files").Required().Shows("FILE.h5");
  command.Add("--out-dir", *out_dir, "Folder for the notebook and the page").Required().Shows("DIR");
  auto work = std::make_shared<WorkOptions>();
  work->AddThreadsTo(command);
  work->AddQuietTo(command);
  command.Runs(run, [=, folder = app.program().report_folder] {
    return RunReport(folder, *files, *out_dir, work->threads);
  });
}

}  // namespace sinew
