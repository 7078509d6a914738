// sinew data kinematics: inverse kinematics of every trial with markers.
#include "base/numbers.h"
#include "base/read_file.h"
#include "base/text.h"
#include "cli/command_files.h"
#include "cli/data/data_commands.h"
#include "cli/data/dataset_json.h"
#include "cli/data/model_file.h"
#include "cli/terminal.h"
#include "cli/work_options.h"
#include "datasets/io/dataset_file.h"
#include "models/multibody/osim_reader.h"
#include "problems/marker_kinematics.h"

namespace sinew {
namespace {

struct KinematicsWords {
  std::string path;
  std::string model;
  std::string weights;
  std::string json;
  WorkOptions work;
};

nlohmann::ordered_json InFrames(const std::vector<std::pair<std::string, int>>& coordinates) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const auto& [name, frames] : coordinates) json.push_back({{"coordinate", name}, {"frames", frames}});
  return json;
}

std::string DescribeSearch(const KinematicsFit& fit) {
  std::string text =
      fit.agreeing_starts > 0
          ? fmt::format("\n  {} of {} starts end at the lowest cost", fit.agreeing_starts, fit.starts)
          : fmt::format(
                "\n  none of {} starts ends at the lowest cost, which single angles drawn anew reached",
                fit.starts);
  if (fit.redone > 0) text += fmt::format("; {} of {} frames left a wrong minimum", fit.redone, fit.frames);
  return text;
}

std::string Describe(const KinematicsFit& fit) {
  std::string text = fmt::format("{}: {} frames, {} markers: {} mm RMS, {} mm at most", fit.trial, fit.frames,
                                 fit.markers, Readable(1e3 * fit.rms_m), Readable(1e3 * fit.max_m));
  if (!fit.worst_marker.empty()) {
    text +=
        fmt::format(" ({} at {} s, frame {})", fit.worst_marker, Readable(fit.worst_time), fit.worst_frame);
    text += DescribeSearch(fit);
  }
  if (!fit.unmatched.empty()) text += "\n  not in the model, left out: " + Join(fit.unmatched, ", ");
  if (!fit.undetermined.empty())
    text +=
        "\n  free, but no marker moves with them; they keep their defaults: " + Join(fit.undetermined, ", ");
  for (const auto& [name, frames] : fit.undetermined_in)
    text += fmt::format(
        "\n  no marker moves with {} in {} frames; it stays near its neighbours' values there", name, frames);
  if (fit.unconverged > 0) text += fmt::format("\n  {} frames did not converge", fit.unconverged);
  return text + "\n";
}

nlohmann::ordered_json FitsJson(const std::vector<KinematicsFit>& fits) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const KinematicsFit& fit : fits) {
    json.push_back({{"trial", fit.trial},
                    {"frames", fit.frames},
                    {"markers", fit.markers},
                    {"rms_m", fit.rms_m},
                    {"max_m", fit.max_m},
                    {"worst_marker", fit.worst_marker},
                    {"worst_frame", fit.worst_frame},
                    {"worst_time_s", fit.worst_time},
                    {"unmatched", fit.unmatched},
                    {"undetermined", fit.undetermined},
                    {"undetermined_in", InFrames(fit.undetermined_in)},
                    {"unconverged_frames", fit.unconverged},
                    {"starts", fit.starts},
                    {"agreeing_starts", fit.agreeing_starts},
                    {"redone_frames", fit.redone}});
  }
  return json;
}

nlohmann::ordered_json ToJson(const Dataset& data, const std::vector<KinematicsFit>& fits) {
  nlohmann::ordered_json json = DatasetJson(data);
  json["marker_fit"] = FitsJson(fits);
  return json;
}

Result<int> Kinematics(const KinematicsWords& words) {
  const auto limit = words.work.LimitThreads();
  SINEW_ASSIGN(const FileLocks locks, ClaimInPlace(words.path, "", {words.model, words.weights}, words.json));
  SINEW_ASSIGN(Dataset data, ReadDataset(words.path));
  SINEW_ASSIGN(const ModelFile model_file, OpenModel(words.model, words.path, data));
  SINEW_ASSIGN(const OsimModel osim, ReadOsim(model_file.text, model_file.name));
  SINEW_ASSIGN(const MultibodyModel model, MultibodyModel::Build(osim));
  IkSetup setup;
  if (!words.weights.empty()) {
    SINEW_ASSIGN(const std::string text, ReadFile(words.weights));
    SINEW_ASSIGN(setup, ReadIkSetup(text, words.weights));
  }

  ProgressLine line("kinematics", words.work.quiet);
  const auto progress = [&line](int done, int all) { line.Show(done, all); };
  const auto fits =
      AddCoordinates(model, words.weights.empty() ? nullptr : &setup, words.work.seed, progress, data);
  line.Clear();
  if (!fits) return Fail("{}: {}", words.path, fits.error().message);
  if (fits->empty()) return Fail("{}: no trial has a grid 'markers'", words.path);
  data.files["kinematics.json"] = FitsJson(*fits).dump(2);
  SINEW_TRY(WriteDataset(words.path, data));
  std::string report;
  for (const KinematicsFit& fit : *fits) report += Describe(fit);
  SINEW_TRY(Report(
      words.json, [&] { return ToJson(data, *fits); }, report));
  return kDone;
}

}  // namespace

void AddKinematicsCommand(Command data, const RunAction& run) {
  auto words = std::make_shared<KinematicsWords>();
  Command command = data.AddCommand("kinematics", "Inverse kinematics: coordinates of a model from markers");
  command.Add("file", words->path).Required().Shows("F.h5");
  command.Add("--model", words->model, "OpenSim model; default: model.osim inside the data set")
      .Shows("M.osim");
  command
      .Add("--weights", words->weights,
           "OpenSim inverse kinematics setup with marker weights; default: all 1")
      .Shows("SETUP.xml");
  AddJsonTo(command, words->json);
  words->work.AddSeedTo(command);
  words->work.AddThreadsTo(command);
  words->work.AddQuietTo(command);
  command.Runs(run, [=] { return Kinematics(*words); });
}

}  // namespace sinew
