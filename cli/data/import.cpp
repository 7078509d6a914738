// sinew data import: measured files become a trial of a data set.
#include "datasets/io/import.h"

#include <cstdio>
#include <filesystem>

#include "base/read_file.h"
#include "cli/command_files.h"
#include "cli/data/data_commands.h"
#include "cli/data/dataset_json.h"
#include "cli/terminal.h"
#include "cli/work_options.h"
#include "datasets/io/dataset_file.h"
#include "models/multibody/multibody_model.h"
#include "models/multibody/osim_reader.h"
#include "problems/kit/coordinate_kinds.h"

namespace sinew {
namespace {

void PrintNotes(const std::vector<std::string>& notes) {
  for (const std::string& note : notes) Print(stderr, Wrapped("note: " + note, 0));
}

struct ImportWords {
  std::vector<std::string> files;
  std::string out;
  std::string map;
  std::string trial;
  std::string role;
  std::vector<std::string> plates;
  std::string external_loads;
  std::string title;
  std::string subject;
  std::string source;
  std::string licence;
  std::string json;
  bool append = false;
};

// Which columns of a motion file are angles is known from the model: the one imported with it, or one already
// there.
Result<std::shared_ptr<const MultibodyModel>> FindModel(const ImportWords& words, const Dataset& data) {
  std::string text;
  std::string name;
  for (const std::string& file : words.files) {
    if (std::filesystem::path(file).extension() != ".osim") continue;
    SINEW_ASSIGN(text, ReadFile(file));
    name = file;
  }
  const auto stored = data.files.find("model.osim");
  if (text.empty() && stored != data.files.end()) {
    text = stored->second;
    name = words.out + "/files/model.osim";
  }
  if (text.empty()) return std::shared_ptr<const MultibodyModel>();
  SINEW_ASSIGN(const OsimModel osim, ReadOsim(text, name));
  SINEW_ASSIGN(MultibodyModel model, MultibodyModel::Build(osim));
  return std::shared_ptr<const MultibodyModel>(std::make_shared<MultibodyModel>(std::move(model)));
}

Result<int> Import(const ImportWords& words) {
  std::vector<std::string> read = words.files;
  read.insert(read.end(), {words.map, words.external_loads});
  SINEW_ASSIGN(const FileLocks locks, ClaimFiles({read, {words.out}, words.json}));
  Dataset data;
  if (words.append && std::filesystem::exists(words.out)) {
    SINEW_ASSIGN(data, ReadDataset(words.out));
  }
  ImportOptions options;
  options.trial = words.trial;
  SINEW_ASSIGN(options.role, ParseRole(words.role));
  options.append = words.append;
  SINEW_ASSIGN(const auto model, FindModel(words, data));
  if (model) {
    options.coordinate_kind = CoordinateKindsOf(*model);
    if (data.constants.count("body_mass") == 0) data.constants["body_mass"] = {model->total_mass_kg(), "kg"};
  }
  if (!words.map.empty()) {
    SINEW_ASSIGN(options.map, ReadImportMap(words.map));
  }
  for (const std::string& text : words.plates) {
    SINEW_ASSIGN(const auto plate, ParsePlates(text));
    options.plates.insert(options.plates.end(), plate.begin(), plate.end());
  }
  if (!words.external_loads.empty()) {
    SINEW_ASSIGN(options.external_loads, ReadExternalLoads(words.external_loads));
  }
  for (const auto& [text, target] :
       {std::pair{&words.title, &data.title}, std::pair{&words.subject, &data.subject},
        std::pair{&words.source, &data.source}, std::pair{&words.licence, &data.licence}}) {
    if (!text->empty()) *target = *text;
  }
  std::vector<std::string> notes;
  SINEW_TRY(ImportFiles(words.files, options, data, notes));
  SINEW_TRY(WriteDataset(words.out, data));
  PrintNotes(notes);
  SINEW_TRY(Report(
      words.json, [&] { return DatasetJson(data); },
      fmt::format("{}: {} trials, {} files\n", words.out, data.trials.size(), data.files.size())));
  return kDone;
}

}  // namespace

void AddImportCommand(Command data, const RunAction& run) {
  auto words = std::make_shared<ImportWords>();
  Command command = data.AddCommand("import", "Import measured files as a trial of a data set");
  command.Add("files", words->files, ".trc .mot .sto .csv .mat .osim .xml .yaml .obj")
      .Required()
      .Shows("FILE");
  command.Add("--out", words->out, "Data set to write").Required().Shows("F.h5");
  command.Add("--map", words->map, "Which columns mean what (docs/import.md)").Shows("MAP.yaml");
  command.Add("--trial", words->trial, "Name of the trial; default: that of the first file");
  command.Add("--role", words->role, "train or validate");
  command.AddFlag("--append", words->append, "Add to the data set if it exists");
  command.Add("--plates", words->plates, "Force plates: NAME=PREFIX of their columns")
      .Split(',')
      .Shows("right=PREFIX,left=PREFIX");
  command.Add("--external-loads", words->external_loads, "Force plates as OpenSim names them").Shows("X.xml");
  command.Add("--title", words->title, "What these data are");
  command.Add("--subject", words->subject, "Whose");
  command.Add("--source", words->source, "From where");
  command.Add("--licence", words->licence, "Under which terms");
  AddJsonTo(command, words->json);
  command.Runs(run, [=] { return Import(*words); });
}

}  // namespace sinew
