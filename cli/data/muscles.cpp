// sinew data muscles: lengths and moment arms of muscles along the joint angles of every trial.
#include <memory>

#include "base/text.h"
#include "cli/command_files.h"
#include "cli/data/data_commands.h"
#include "cli/data/dataset_json.h"
#include "cli/data/model_file.h"
#include "cli/terminal.h"
#include "cli/work_options.h"
#include "datasets/io/dataset_file.h"
#include "problems/nms/muscle/muscle_grids.h"

namespace sinew {
namespace {

struct MusclesWords {
  std::string path;
  std::string model;
  std::vector<std::string> muscles;
  std::vector<std::string> joints;
  bool skip_unsupported = false;
  std::string out;
  std::string json;
  WorkOptions work;
};

Result<int> Muscles(const MusclesWords& words) {
  const std::string out = words.out.empty() ? words.path : words.out;
  SINEW_ASSIGN(const FileLocks locks, ClaimInPlace(words.path, words.out, {words.model}, words.json));
  SINEW_ASSIGN(Dataset data, ReadDataset(words.path));
  SINEW_ASSIGN(const ModelFile model_file, OpenModel(words.model, words.path, data));
  SINEW_ASSIGN(const MuscleGrids grids,
               MuscleGrids::Build(model_file.text, model_file.name,
                                  {words.muscles, words.joints, words.skip_unsupported, "--joints",
                                   "--skip-unsupported leaves them out"}));
  std::string report;
  for (const UnsupportedMuscle& one : grids.skipped())
    report += fmt::format("left out: {}, for {} is not supported\n", one.muscle, one.part);
  bool any = false;
  int done = 0;
  ProgressLine line("muscles", words.work.quiet);
  for (auto& [name, trial] : data.trials) {
    const Grid* motion = grids.FindMotion(trial);
    if (motion == nullptr) {
      report += fmt::format("{}: holds no coordinate of the model, left as it is\n", name);
      continue;
    }
    any = true;
    const auto said = grids.Add(*motion, trial);
    if (!said) return Fail("{}: trial '{}': {}", words.path, name, said.error().message);
    report += name + ": " + *said;
    line.Show(++done, static_cast<int>(data.trials.size()));
  }
  line.Clear();
  if (!grids.over_several_objects().empty()) {
    report += fmt::format(
        "{}: where such a path touches two wrap objects at once, OpenSim's own length is too short by up to "
        "millimetres; a difference to its lengths there is no error (docs/muscle_geometry.md)\n",
        Join(grids.over_several_objects(), ", "));
  }
  if (!any) {
    return Fail(
        "{}: no trial holds a coordinate of the model; import joint angles, or run `sinew data "
        "kinematics` on markers",
        words.path);
  }
  SINEW_TRY(WriteDataset(out, data));
  SINEW_TRY(Report(
      words.json, [&] { return DatasetJson(data); }, report));
  return kDone;
}

}  // namespace

void AddMusclesCommand(Command data, const RunAction& run) {
  auto words = std::make_shared<MusclesWords>();
  Command command = data.AddCommand(
      "muscles",
      "Lengths and moment arms of a model's muscles along the joint angles (docs/muscle_geometry.md)");
  command.Add("file", words->path).Required().Shows("F.h5");
  command.Add("--model", words->model, "OpenSim model; default: model.osim inside the data set")
      .Shows("M.osim");
  command.Add("--muscles", words->muscles, "Default: all of the model")
      .Split(',')
      .Shows("soleus_r,med_gas_r");
  command
      .Add("--joints", words->joints,
           "Angles about which moment arms are wanted; all: every angle that a muscle moves")
      .Split(',')
      .Required()
      .Shows("ankle_angle_r,knee_angle_r");
  command.AddFlag("--skip-unsupported", words->skip_unsupported,
                  "Leave out muscles that wrap over ellipsoids or tori, and list them");
  command.Add("--out", words->out, "Data set to write; default: the same").NotEmpty().Shows("G.h5");
  AddJsonTo(command, words->json);
  words->work.AddQuietTo(command);
  command.Runs(run, [=] { return Muscles(*words); });
}

}  // namespace sinew
