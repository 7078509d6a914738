#include "problems/ankle_study/nms_synthesis.h"

#include <algorithm>

#include "problems/ankle_study/recording.h"
#include "problems/kit/bind.h"
#include "problems/kit/experiment_settings.h"
#include "problems/kit/hidden_effects.h"
#include "problems/nms/problem.h"

namespace sinew {
namespace {

constexpr ExperimentSetting kNmsSettings[] = {
    {"triceps.strength", 0.8, 0.5, 1.5, "true factor on the force of gastrocnemii and soleus"},
    {"peronei.strength", 1.2, 0.5, 1.5, "true factor on the force of peroneus longus and brevis"},
    {"dorsiflexors.strength", 1.1, 0.5, 1.5,
     "true factor on the force of tibialis anterior and peroneus tertius"},
    {"plantarflexors.shape", -1.2, -3, 0, "true shape factor of gastrocnemii, soleus and peronei"},
    {"dorsiflexors.shape", -0.8, -3, 0, "true shape factor of tibialis anterior and peroneus tertius"},
    {"triceps.tendon_slack_length", 1.01, 0.95, 1.05, "true factor on the subject's"},
    {"dorsiflexors.tendon_slack_length", 0.98, 0.95, 1.05, "true factor on the subject's"},
    {"train", 4, 1, 4, "training trials: those at 120, 90, 60 and 30 deg/s, in this order"},
    {"validate", 2, 0, 2, "validation trials: those at 75 and 45 deg/s, in this order"},
    {"cycles", 4, 1, 100, "up and down again, per trial"},
    {"moment_noise", 1, 0, 100, "standard deviation of the moment's noise [N m]"},
    {"electrodes", 1024, 0, 100000,
     "per muscle, whose envelopes are averaged; 0: excitations are the true ones"},
    {"raw", 0, 0, 1, "1: the raw EMG of one electrode per muscle is in the data too"},
    {"known_noise", 0, 0, 1, "1: the data state the noise level of the moment"},
    {"exact", 0, 0, 1, "1: no noise, and moments of the fitted model itself"},
};

constexpr StudyTrial kTrials[] = {
    {"train_120", 120, Role::kTrain},     {"train_90", 90, Role::kTrain},
    {"train_60", 60, Role::kTrain},       {"train_30", 30, Role::kTrain},
    {"validate_75", 75, Role::kValidate}, {"validate_45", 45, Role::kValidate},
};

// Errors that no effect of the problem describes, as tests of the diagnosis. Each has one number of its name.
constexpr Outsider kNmsOutsiders[] = {
    {"ripple", "N*m", "moment that is a sine of the angle"},
    {"tension_curve", "N*m/rad3", "moment that grows with the third power of the angle"},
    {"tremor", "N*m", "moment that is a sine of time, 5 Hz"},
    {"soleus_fades", "1/s", "the EMG of one muscle alone loses this share per second"},
    {"loose_electrode", "1", "the EMG of one muscle alone loses this share half-way"},
    {"bent_arms", "m/rad2", "moment arms that grow with the square of the angle from its middle"},
    {"directional_force", "1",
     "share by which muscles pull more while the angle grows, and less while it falls"},
};

// Effects of the problem that the study can contain; those of a trial alone are left out, but for the
// EMG's.
constexpr const char* kSimulated[] = {"emg_drift",
                                      "co_contraction",
                                      "cross_talk",
                                      "longer_delay",
                                      "slower_activation",
                                      "force_enhancement",
                                      "force_depression",
                                      "compliant_tendon",
                                      "contraction_velocity",
                                      "length_by_activation",
                                      "fibre_length",
                                      "arm_offset.ankle_angle_r",
                                      "angle_offset.ankle_angle_r",
                                      "missing_muscle_plus.ankle_angle_r",
                                      "missing_muscle_minus.ankle_angle_r",
                                      "passive_stiffness.ankle_angle_r",
                                      "joint_damping.ankle_angle_r",
                                      "inertial_moment.ankle_angle_r",
                                      "segment_weight.ankle_angle_r",
                                      "machine_friction.ankle_angle_r",
                                      "ankle_angle_r_moment.offset",
                                      "ankle_angle_r_moment.drift",
                                      "ankle_angle_r_moment.gain",
                                      "ankle_angle_r_moment.time_offset",
                                      "ankle_angle_r_moment.low_pass"};

bool IsSimulated(const std::string& name) {
  const auto among = [&](const auto& names) {
    return std::find(std::begin(names), std::end(names), name) != std::end(names);
  };
  return name.rfind("emg_gain@", 0) == 0 || name.rfind("emg_offset@", 0) == 0 || among(kSimulated) ||
         std::any_of(std::begin(kNmsOutsiders), std::end(kNmsOutsiders),
                     [&](const Outsider& outsider) { return name == outsider.name; });
}

Result<NmsSettings> NmsSettingsOf(const Dataset& data) {
  SINEW_ASSIGN(const YamlReader section, SettingsSection(data, "nms"));
  return ReadNmsSettings(section, data.files);
}

Result<Dataset> Record(const StudyTruth& truth, std::uint64_t seed) {
  Dataset data;
  data.title = "an ankle on a dynamometer, made up";
  data.source = "sinew data synthesize nms";
  data.licence = "CC0-1.0";
  data.synthetic = true;
  data.files["nms.yaml"] =
      StudyNmsSettings({"How the nms problem sees the ankle study.", "per_long_r, per_brev_r",
                        "tib_ant_r, per_tert_r", "0.5", "1.5"});
  data.files["subject.xml"] = StudySubjectXml();
  std::uint64_t stream = 0;
  double train = truth.settings.at("train");
  double validate = truth.settings.at("validate");
  for (const StudyTrial& trial : kTrials) {
    double& left = trial.role == Role::kTrain ? train : validate;
    if (left-- < 1) continue;
    SINEW_ASSIGN(data.trials[trial.name], RecordStudyTrial(truth, trial, Random::StreamSeed(seed, stream++)));
  }
  SINEW_TRY(data.Check());
  return data;
}

// Checks names and ranges against what the problem itself would offer on such data.
Status ReadEffects(const SynthesisRequest& request, StudyTruth& truth) {
  if (request.effects.empty()) return {};
  StudyTruth plain = truth;
  plain.settings["exact"] = 1;
  SINEW_ASSIGN(const Dataset data, Record(plain, request.seed));
  SINEW_ASSIGN(NmsSettings settings, NmsSettingsOf(data));
  SINEW_ASSIGN(auto bare, NmsProblem::Make(data, std::move(settings)));
  const SensorEffects problem(std::move(bare));
  const auto& parameters = problem.parameters();
  SINEW_ASSIGN(truth.effects,
               ReadHiddenEffects(request.effects, EffectsOf(problem), ListOutsiders(kNmsOutsiders)));
  for (const auto& [name, numbers] : request.effects) {
    if (!IsSimulated(name)) return Fail("--effect {}: the ankle study cannot contain it", name);
  }
  // Gains rest at 1.
  for (const Parameter& p : parameters) {
    const auto hidden = truth.effects.find(p.name);
    if (hidden != truth.effects.end()) hidden->second -= p.null_value;
  }
  return {};
}

}  // namespace

Result<Dataset> SynthesizeNms(const SynthesisRequest& request) {
  StudyTruth truth;
  SINEW_ASSIGN(truth.settings, ReadExperiment(kNmsSettings, {"moment_noise"}, request));
  if (request.noise)
    truth.settings["electrodes"] *= *request.noise > 0 ? 1 / (*request.noise * *request.noise) : 0;
  SINEW_TRY(ReadEffects(request, truth));
  return Record(truth, request.seed);
}

std::vector<std::pair<std::string, std::string>> NmsExperiment() {
  return DescribeSettings(kNmsSettings);
}

std::vector<Parameter> DefaultNmsParameters() {
  SynthesisRequest request;
  request.set = {{"exact", 1}, {"cycles", 1}};
  const auto data = SynthesizeNms(request);
  if (!data) return {};
  auto settings = NmsSettingsOf(*data);
  if (!settings) return {};
  const auto problem = NmsProblem::Make(*data, std::move(*settings));
  return problem ? (*problem)->parameters() : std::vector<Parameter>();
}

}  // namespace sinew
