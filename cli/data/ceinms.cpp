// sinew data ceinms: a CEINMS project becomes a data set; sinew data subject: a calibrated subject becomes a
// CEINMS file again.
#include <cstdio>

#include "base/hdf5_tree.h"
#include "base/replace_file.h"
#include "base/text.h"
#include "cli/command_files.h"
#include "cli/data/data_commands.h"
#include "cli/data/dataset_json.h"
#include "cli/terminal.h"
#include "cli/work_options.h"
#include "datasets/io/dataset_file.h"
#include "datasets/io/text_file.h"
#include "problems/nms/ceinms/project.h"

namespace sinew {
namespace {

struct ProjectWords {
  std::string setup;
  std::string out;
  std::string execution;
  std::vector<std::string> validate;
  std::string json;
};

Result<int> ImportProject(const ProjectWords& words) {
  CommandFiles files{{words.setup, words.execution}, {words.out}, words.json};
  SINEW_ASSIGN(const FileLocks locks, ClaimFiles(files));
  const TextFilesRead read;
  SINEW_ASSIGN(const CeinmsProject project, ReadCeinmsProject(words.setup, words.validate, words.execution));
  files.read = read.paths();  // now with all that the setup names
  SINEW_TRY(CheckFiles(files));
  SINEW_TRY(WriteDataset(words.out, project.data));
  for (const std::string& note : project.notes) Print(stderr, Wrapped("note: " + note, 0));
  std::size_t train = 0;
  for (const auto& [name, trial] : project.data.trials) train += trial.role == Role::kTrain ? 1 : 0;
  SINEW_TRY(Report(
      words.json, [&] { return DatasetJson(project.data); },
      fmt::format("{}: {} trials to fit, {} to predict, subject.xml and nms.yaml\n", words.out, train,
                  project.data.trials.size() - train)));
  return kDone;
}

struct SubjectWords {
  std::string run;
  std::string out;
};

Result<int> WriteSubject(const SubjectWords& words) {
  SINEW_ASSIGN(const FileLocks locks, ClaimFiles({{words.run}, {words.out}, ""}));
  SINEW_ASSIGN(const Hdf5Node root, ReadHdf5(words.run));
  const Hdf5Node* node = root.Find("details/subject");
  const std::string* text = node == nullptr ? nullptr : node->text();
  if (text == nullptr) return Fail("{}: holds no subject: expected a run of `sinew identify nms`", words.run);
  SINEW_TRY(ReplaceFile(words.out, *text));
  Print(stdout, fmt::format("{}: the subject of {}\n", words.out, words.run));
  return kDone;
}

}  // namespace

void AddCeinmsCommand(Command data, const RunAction& run) {
  auto words = std::make_shared<ProjectWords>();
  Command command =
      data.AddCommand("ceinms", "Convert a CEINMS or CEINMS-RT project to a data set (docs/nms.md)");
  command
      .Add("setup", words->setup,
           "Setup of a CEINMS calibration or execution, or CEINMS-RT's calibration (<simulatedAnnealing>)")
      .Required()
      .Shows("SETUP.xml");
  command
      .Add("--validate", words->validate,
           "Trials that are predicted and never fitted; of CEINMS-RT: TRIAL or TRIAL:FROM:TO [s]")
      .Split(',')
      .Shows("TRIAL.xml");
  command
      .Add("--execution", words->execution,
           "CEINMS-RT's execution file, which states the tendon model; default: executionRT.xml beside "
           "SETUP.xml")
      .Shows("EXECUTION.xml");
  command.Add("--out", words->out, "Data set to write").Required().Shows("F.h5");
  AddJsonTo(command, words->json);
  command.Runs(run, [words] { return ImportProject(*words); });
}

void AddSubjectCommand(Command data, const RunAction& run) {
  auto words = std::make_shared<SubjectWords>();
  Command command = data.AddCommand("subject", "The calibrated subject of an nms run, as a CEINMS file");
  command.Add("run", words->run).Required().Shows("RUN.h5");
  command.Add("--out", words->out, "File to write").Required().Shows("SUBJECT.xml");
  command.Runs(run, [words] { return WriteSubject(*words); });
}

}  // namespace sinew
