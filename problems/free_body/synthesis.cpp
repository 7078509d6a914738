#include "problems/free_body/synthesis.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/constants.h"
#include "base/random.h"
#include "problems/free_body/data.h"
#include "problems/free_body/problem.h"
#include "problems/kit/experiment_settings.h"
#include "problems/kit/hidden_effects.h"

namespace sinew {
namespace {

constexpr ExperimentSetting kSettings[] = {
    {"stiffness", 0, 0, 1e15, "true stiffness [N/m^1.5, elastic_foundation N/m3]; 0: 1e6, or 2e9"},
    {"dissipation", 1.5, 0.01, 100, "true dissipation [s/m]"},
    {"friction", 0.2, 0, 2, "true friction coefficient"},
    {"elastic_foundation", 0, 0, 1, "1: the faces carry springs, not the corners"},
    {"horizon", 0.2, 0, 100, "after the first touch that is compared [s]; 0: until rest"},
    {"window", 0, 0, 100, "after which the fitted simulation starts anew [s]; 0: never"},
    {"train", 6, 1, 1000, "number of training tosses"},
    {"validate", 3, 0, 1000, "number of validation tosses"},
    {"duration", 0.7, 0.1, 10, "of a toss [s]"},
    {"rate", 148, 20, 5000, "frames per second [Hz]"},
    {"speed", 1, 0, 10, "of the throw [m/s]"},
    {"spin", 6, 0, 50, "of the throw [rad/s]"},
    {"height", 0.08, 0, 10, "of the throw: of the lowest point over the table [m]"},
    {"position_noise", 3e-5, 0, 1, "standard deviation of the position's noise [m]"},
    {"orientation_noise", 3e-4, 0, 1, "standard deviation of the quaternion's noise [1]"},
    {"known_noise", 1, 0, 1, "0: the data do not state the noise level"},
    {"exact", 0, 0, 1, "1: no noise, and the integrator of the fitted model"},
};

constexpr double kEdge = 0.1048;  // [m]
constexpr double kMass = 0.37;    // [kg]
constexpr double kInertia = 8.1e-4;

using Values = std::map<std::string, double>;

std::string SettingsText(const Values& values) {
  return fmt::format(
      "# How the free_body problem sees this cube.\nfree_body:\n  box: [{0}, {0}, {0}]\n  mass: {1}\n"
      "  inertia: [{2}, {2}, {2}]\n  contact: {3}\n  horizon: {4}\n  window: {5}\n",
      kEdge, kMass, kInertia, values.at("elastic_foundation") != 0 ? "elastic_foundation" : "vertices",
      values.at("horizon"), values.at("window"));
}

Status HideEffects(const RequestedEffects& requested, const ParameterList& list, FreeBodyNumbers& truth) {
  SINEW_ASSIGN(const auto hidden, ReadHiddenEffects(requested, list));
  for (const auto& [parameter, value] : hidden) {
    SINEW_ASSIGN(const int index, FindParameter(list.parameters, parameter));
    for (std::size_t slot = 0; slot < truth.value.size(); ++slot) {
      if (list.index[slot] == index) truth.value[slot] = value;
    }
  }
  return {};
}

FlightStart Throw(const Values& values, const FreeBody& body, Random& random) {
  FlightStart start;
  double length = 0;
  for (std::size_t i = 3; i < start.pose.size(); ++i) {
    start.pose[i] = random.Normal();
    length += start.pose[i] * start.pose[i];
  }
  for (std::size_t i = 3; i < start.pose.size(); ++i) start.pose[i] /= std::sqrt(length);
  const double heading = random.Uniform(0, 2 * kPi);
  start.pose[0] = 0.2 * random.Normal();
  start.pose[1] = 0.2 * random.Normal();
  start.pose[2] = body.reach + values.at("height") * random.Uniform(0.8, 1.2);
  start.velocity << values.at("speed") * std::cos(heading), values.at("speed") * std::sin(heading),
      0.3 * values.at("speed") * random.Normal();
  for (int i = 0; i < 3; ++i) start.spin[i] = values.at("spin") / std::sqrt(3.0) * random.Normal();
  return start;
}

Result<Trial> RecordToss(const Values& values, const FreeBody& body, const FreeBodyNumbers& truth,
                         std::uint64_t seed) {
  Random random(seed);
  std::vector<double> times;
  const auto frames = static_cast<std::size_t>(values.at("duration") * values.at("rate"));
  for (std::size_t i = 0; i <= frames; ++i) times.push_back(static_cast<double>(i) / values.at("rate"));
  const bool exact = values.at("exact") != 0;
  FlightLimits limits;
  limits.accuracy = exact ? body.accuracy : 0.01 * body.accuracy;
  limits.most_steps = 1000000;
  std::vector<Pose> poses(times.size());
  const FlightStart start = Throw(values, body, random);
  SINEW_TRY(Fly(body, truth.value, truth.Used(), start, -1, times, limits, poses.data()));
  Trial trial;
  trial.task = "toss";
  Grid& grid = trial.grids["pose"];
  grid.time = times;
  for (std::size_t c = 0; c < kPoseNames.size(); ++c) {
    Channel channel;
    channel.unit = c < 3 ? "m" : "1";
    const double noise = exact ? 0 : values.at(c < 3 ? "position_noise" : "orientation_noise");
    for (const Pose& pose : poses) channel.values.push_back(pose[c] + noise * random.Normal());
    if (noise > 0 && values.at("known_noise") != 0) channel.sigma = noise;
    grid.channels[kPoseNames[c]] = std::move(channel);
  }
  return trial;
}

}  // namespace

Result<Dataset> SynthesizeFreeBody(const SynthesisRequest& request) {
  SINEW_ASSIGN(Values values, ReadExperiment(kSettings, {"position_noise", "orientation_noise"}, request));
  const std::string text = SettingsText(values);
  SINEW_ASSIGN(const YamlReader yaml, YamlReader::Parse(text, "free_body.yaml"));
  SINEW_ASSIGN(const YamlReader section, yaml.At("free_body"));
  SINEW_ASSIGN(FreeBodySettings settings, ReadFreeBodySettings(section));
  FreeBody& body = settings.body;
  for (auto& knots : body.knots) knots.assign(kFreeBodyKnots, 0);
  const bool vertices = body.contact == FreeBodyContact::kVertices;
  if (values["stiffness"] == 0) values["stiffness"] = vertices ? 1e6 : 2e9;
  FreeBodyNumbers truth;
  truth.value[kStiffness] = values.at("stiffness");
  truth.value[kDissipation] = values.at("dissipation");
  truth.value[kFriction] = values.at("friction");
  SINEW_TRY(
      HideEffects(request.effects, ListFreeBodyParameters(body, std::max(values.at("speed"), 0.1)), truth));

  Dataset data;
  data.title = "tosses of a cube, made up";
  data.source = "sinew data synthesize free_body";
  data.licence = "CC0-1.0";
  data.synthetic = true;
  data.files["free_body.yaml"] = text;
  const auto train = static_cast<std::size_t>(values.at("train"));
  const auto count = train + static_cast<std::size_t>(values.at("validate"));
  for (std::size_t i = 0; i < count; ++i) {
    const std::string name = SyntheticTrialName(i, train);
    auto trial = RecordToss(values, body, truth, Random::StreamSeed(request.seed, i));
    if (!trial) return Fail("{}: {}", name, trial.error().message);
    trial->role = i < train ? Role::kTrain : Role::kValidate;
    data.trials[name] = std::move(*trial);
  }
  SINEW_TRY(data.Check());
  return data;
}

std::vector<std::pair<std::string, std::string>> FreeBodyExperiment() {
  return DescribeSettings(kSettings);
}

}  // namespace sinew
