// sinew data dynamics: what the ground has to do so that a whole body moves as recorded.
#include <cmath>
#include <optional>

#include "base/text.h"
#include "cli/command_files.h"
#include "cli/data/data_commands.h"
#include "cli/data/dataset_json.h"
#include "cli/data/model_file.h"
#include "cli/work_options.h"
#include "datasets/io/dataset_file.h"
#include "models/multibody/osim_reader.h"
#include "problems/whole_body_dynamics.h"

namespace sinew {
namespace {

struct DynamicsWords {
  std::string path;
  std::string model;
  std::optional<double> cutoff;
  std::string out;
  std::string json;
};

std::string Describe(const WholeBodyDynamics& done) {
  if (done.kept) return fmt::format("{}: kept as it was cut from its recording\n", done.trial);
  std::string text =
      fmt::format("{}: {} frames, {:.1f} kg; the ground carries {:.3f} times the weight on average\n",
                  done.trial, done.frames, done.mass, done.weight_share);
  if (!done.held.empty()) text += "  no data, held at the model's default: " + Join(done.held, ", ") + "\n";
  return text;
}

nlohmann::ordered_json ToJson(const Dataset& data, const std::vector<WholeBodyDynamics>& all) {
  nlohmann::ordered_json json = DatasetJson(data);
  json["whole_body"] = nlohmann::ordered_json::array();
  for (const WholeBodyDynamics& done : all) {
    if (done.kept) {
      json["whole_body"].push_back({{"trial", done.trial}, {"kept", true}});
      continue;
    }
    json["whole_body"].push_back({{"trial", done.trial},
                                  {"frames", done.frames},
                                  {"mass_kg", done.mass},
                                  {"mean_vertical_force_over_weight", done.weight_share},
                                  {"held", done.held}});
  }
  return json;
}

Result<int> Dynamics(const DynamicsWords& words) {
  const double cutoff = words.cutoff.value_or(kWalkingCutoff);
  if (!(cutoff >= 0 && std::isfinite(cutoff)))
    return Fail("--cutoff {}: expected a frequency in Hz, or 0 for none", cutoff);
  const std::string out = words.out.empty() ? words.path : words.out;
  SINEW_ASSIGN(const FileLocks locks, ClaimInPlace(words.path, words.out, {words.model}, words.json));
  SINEW_ASSIGN(Dataset data, ReadDataset(words.path));
  SINEW_ASSIGN(const ModelFile model_file, OpenModel(words.model, words.path, data));
  SINEW_ASSIGN(const OsimModel osim, ReadOsim(model_file.text, model_file.name));
  const auto done = AddWholeBodyDynamics(osim, cutoff, data);
  if (!done) return Fail("{}: {}", words.path, done.error().message);
  if (done->empty())
    return Fail("{}: no trial holds a coordinate of the model; run `sinew data kinematics` on markers first",
                words.path);
  SINEW_TRY(WriteDataset(out, data));
  std::string report;
  for (const WholeBodyDynamics& one : *done) report += Describe(one);
  SINEW_TRY(Report(
      words.json, [&] { return ToJson(data, *done); }, report));
  return kDone;
}

}  // namespace

void AddDynamicsCommand(Command data, const RunAction& run) {
  auto words = std::make_shared<DynamicsWords>();
  Command command = data.AddCommand(
      "dynamics", "Force and moment of the ground that the motion of a whole body needs (docs/walking.md)");
  command.Add("file", words->path).Required().Shows("F.h5");
  command.Add("--model", words->model, "OpenSim model; default: model.osim inside the data set")
      .Shows("M.osim");
  command.Add(
      "--cutoff", words->cutoff,
      fmt::format("Of the low-pass of all coordinates, in Hz; 0: none; default: {:g}", kWalkingCutoff));
  command.Add("--out", words->out, "Data set to write; default: F.h5 itself").NotEmpty().Shows("G.h5");
  AddJsonTo(command, words->json);
  command.Runs(run, [=] { return Dynamics(*words); });
}

}  // namespace sinew
