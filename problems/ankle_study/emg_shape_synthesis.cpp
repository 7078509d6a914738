#include "problems/ankle_study/emg_shape_synthesis.h"

#include <algorithm>

#include "problems/ankle_study/emg_recording.h"
#include "problems/emg_shape/problem.h"
#include "problems/kit/bind.h"
#include "problems/kit/experiment_settings.h"
#include "problems/kit/hidden_effects.h"

namespace sinew {
namespace {

constexpr double kOwn = -1;  // the person's

constexpr ExperimentSetting kEmgSettings[] = {
    {"subject", 0, 0, 1e6,
     "which person: 0 to 4 are the study's (0, 2, 4 shift phase with speed, 0 and 1 fail at 30 deg/s), "
     "others are "
     "drawn at random"},
    {"lead", kOwn, -1, 0.4, "true lead of all muscles [s]; -1: the person's own"},
    {"lat_gas_r.amplitude_exponent", kOwn, -1, 2, "true exponent; -1: the person's own"},
    {"med_gas_r.amplitude_exponent", kOwn, -1, 2, "true exponent; -1: the person's own"},
    {"per_long_r.amplitude_exponent", kOwn, -1, 2, "true exponent; -1: the person's own"},
    {"soleus_r.amplitude_exponent", kOwn, -1, 2, "true exponent; -1: the person's own"},
    {"tib_ant_r.amplitude_exponent", kOwn, -1, 2, "true exponent; -1: the person's own"},
    {"laws", 1, 0, 1,
     "0: neither size nor phase changes with speed, the model has no laws for it, and electrodes record one "
     "muscle "
     "only"},
    {"train", 9, 0, 1000, "training cycles per speed"},
    {"validate", 3, 0, 1000, "held-out cycles per speed"},
    {"speeds", 6, 1, 6, "the first of 75, 120, 45, 90, 30, 60 deg/s"},
    {"muscles", 5, 1, 5,
     "with EMG: the first of lateral and medial gastrocnemius, peroneus longus, soleus, tibialis anterior"},
    {"noisy", 1, 0, 1, "0: envelopes are the true activations"},
    {"raw", 1, 0, 1, "1: the raw EMG is in the data too"},
    {"moments", 1, 0, 1, "1: what the nms problem needs is in the data too"},
    {"moment_noise", 1, 0, 100, "standard deviation of the moment's noise [N m]"},
    {"exact", 0, 0, 1, "1: no noise, no scatter, and envelopes of the fitted model itself"},
};

constexpr const char* kShapeText = R"(# How the emg_shape problem sees the study: docs/emg_shape.md
emg_shape:
  angle: ankle_angle_r
  cycles: {{begins_at: highest}}
  laws: [{}]
  low_pass: {}   # [Hz] of the envelopes
)";

// Errors that no effect of the problem describes, as tests of the diagnosis. Each has one number of its name.
constexpr Outsider kEmgOutsiders[] = {
    {"lost_bursts", "1", "every third cycle of the first muscle loses this share"},
    {"loose_electrode", "1", "the second muscle loses this share half-way through every recording"},
    {"hum", "1", "1.7 Hz on the first muscle"},
};

Dataset Begin(const EmgStudyTruth& truth) {
  Dataset data;
  data.title = "EMG of an ankle on a dynamometer, made up";
  data.subject = fmt::format("S{}", truth.Set("subject"));
  data.source = "sinew data synthesize emg_shape";
  data.licence = "CC0-1.0";
  data.synthetic = true;
  data.files["emg_shape.yaml"] =
      fmt::format(kShapeText, truth.Set("laws") != 0 && truth.Set("speeds") > 1 ? "amplitude, lead" : "",
                  truth.Set("noisy") != 0 ? 6 : 0);
  if (truth.Set("moments") != 0 && truth.Set("muscles") == kEmgStudyMuscles) {
    data.files["nms.yaml"] =
        StudyNmsSettings({"How the nms problem sees the study.", "per_long_r", "tib_ant_r", "0.2", "4"});
    data.files["subject.xml"] = StudySubjectXml(EmgStudyMuscleNames());
  }
  return data;
}

Result<EmgShapeSettings> EmgSettingsOf(const Dataset& data) {
  SINEW_ASSIGN(const YamlReader section, SettingsSection(data, "emg_shape"));
  return ReadEmgShapeSettings(section);
}

// Replaces the envelopes by what the fitted model makes of the truth; shapes are those that it starts from.
Status MakeExact(const EmgStudyTruth& truth, Dataset& data) {
  SINEW_ASSIGN(EmgShapeSettings settings, EmgSettingsOf(data));
  settings.rate = 1000;  // every sample
  SINEW_ASSIGN(const auto problem, EmgShapeProblem::Make(data, settings));
  Vector point = RestPoint(*problem);
  const auto set = [&](const std::string& name, double value) {
    const auto index = FindParameter(problem->parameters(), name);
    if (index) point[*index] = value;
  };
  set("lead", truth.subject.lead);
  const auto names = EmgStudyMuscleNames();
  for (std::size_t m = 0; m < names.size(); ++m)
    set(names[m] + ".amplitude_exponent", truth.subject.muscles[m].exponent);
  Prediction prediction(problem->layout());
  const auto workspace = problem->NewWorkspace();
  const std::vector<bool> all(problem->layout().size(), true);
  SINEW_TRY(problem->Predict({point, all, false, nullptr}, *workspace, prediction));
  for (std::size_t b = 0; b < problem->layout().size(); ++b) {
    const Block& block = problem->layout()[b];
    const Vector values = prediction.values(static_cast<int>(b));
    data.trials[block.trial].grids["excitations"].channels[block.channel].values.assign(
        values.data(), values.data() + values.size());
  }
  return {};
}

Result<Dataset> Record(const EmgStudyTruth& truth, std::uint64_t seed) {
  Dataset data = Begin(truth);
  SINEW_ASSIGN(data.trials, RecordEmgStudy(truth, seed));
  if (truth.Set("exact") != 0) SINEW_TRY(MakeExact(truth, data));
  SINEW_TRY(data.Check());
  return data;
}

// Checks names and ranges against what the problem itself would offer on such data.
Status ReadEffects(const SynthesisRequest& request, EmgStudyTruth& truth) {
  if (request.effects.empty()) return {};
  EmgStudyTruth plain = truth;
  plain.settings["noisy"] = plain.settings["raw"] = plain.settings["moments"] = 0;
  SINEW_ASSIGN(const Dataset data, Record(plain, request.seed));
  SINEW_ASSIGN(EmgShapeSettings settings, EmgSettingsOf(data));
  SINEW_ASSIGN(const auto problem, EmgShapeProblem::Make(data, std::move(settings)));
  SINEW_ASSIGN(truth.effects,
               ReadHiddenEffects(request.effects, EffectsOf(*problem), ListOutsiders(kEmgOutsiders)));
  const auto names = EmgStudyMuscleNames();
  for (std::size_t m = 0; m < names.size(); ++m)
    truth.subject.muscles[m].exponent += truth.Effect(names[m] + ".amplitude_exponent");
  truth.subject.lead += truth.Effect("lead");
  return {};
}

void ReadPerson(EmgStudyTruth& truth) {
  EmgSubject& subject = truth.subject;
  subject = DrawEmgSubject(static_cast<int>(truth.Set("subject")));
  const bool laws = truth.Set("laws") != 0;
  const bool exact = truth.Set("exact") != 0;
  const auto names = EmgStudyMuscleNames();
  for (std::size_t m = 0; m < names.size(); ++m) {
    EmgSubjectMuscle& muscle = subject.muscles[m];
    const double stated = truth.settings.at(names[m] + ".amplitude_exponent");
    if (stated != kOwn) {
      muscle.exponent = stated;
    } else if (!laws) {
      muscle.exponent = 0;
    }
    if (!laws || exact) muscle.lead = 0;
  }
  if (truth.Set("lead") != kOwn) {
    subject.lead = truth.Set("lead");
  } else if (!laws) {
    subject.lead = 0;
  }
  if (!exact) return;
  truth.settings["noisy"] = truth.settings["raw"] = 0;
  subject.habits = {};
  subject.gain_scatter = subject.timing_scatter = subject.cross_talk = 0;
  subject.fails_slow = false;
}

}  // namespace

Result<Dataset> SynthesizeEmgShape(const SynthesisRequest& request) {
  EmgStudyTruth truth;
  SINEW_ASSIGN(truth.settings, ReadExperiment(kEmgSettings, {"moment_noise"}, request));
  if (truth.Set("raw") != 0) truth.settings["noisy"] = 1;
  if (request.noise && *request.noise == 0) truth.settings["noisy"] = truth.settings["raw"] = 0;
  ReadPerson(truth);
  SINEW_TRY(ReadEffects(request, truth));
  return Record(truth, request.seed);
}

std::vector<std::pair<std::string, std::string>> EmgShapeExperiment() {
  return DescribeSettings(kEmgSettings);
}

std::vector<Parameter> DefaultEmgShapeParameters() {
  SynthesisRequest request;
  request.set = {{"exact", 1}, {"train", 2}, {"validate", 0}, {"moments", 0}};
  const auto data = SynthesizeEmgShape(request);
  if (!data) return {};
  auto settings = EmgSettingsOf(*data);
  if (!settings) return {};
  const auto problem = EmgShapeProblem::Make(*data, std::move(*settings));
  return problem ? (*problem)->parameters() : std::vector<Parameter>();
}

}  // namespace sinew
