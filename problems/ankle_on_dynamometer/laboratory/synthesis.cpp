#include "problems/ankle_on_dynamometer/laboratory/synthesis.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/constants.h"
#include "base/random.h"
#include "identify/execution/executor.h"
#include "models/muscle/activation.h"
#include "problems/ankle_on_dynamometer/laboratory/simulation.h"
#include "problems/ankle_on_dynamometer/problem.h"
#include "problems/ankle_on_dynamometer/trial_run.h"
#include "problems/ankle_study/study.h"
#include "problems/kit/experiment_settings.h"
#include "problems/kit/hidden_effects.h"

namespace sinew {
namespace {

constexpr ExperimentSetting kSettings[] = {
    {"duration", 8, 1, 600, "of every trial [s]"},
    {"rate", 200, 50, 2000, "samples per second of angle, torque and excitations [Hz]"},
    {"torque_noise", 0.3, 0, 100, "standard deviation of the torque's noise [N m]"},
    {"angle_noise", 2e-4, 0, 1, "standard deviation of the noise of the machine's angle [rad]"},
    {"ankle_noise", 3e-3, 0, 1, "standard deviation of the noise of the ankle's angle [rad]"},
    {"emg_noise", 0, 0, 1, "standard deviation of the noise of the excitations"},
    {"ankle_angle", 1, 0, 1, "0: the ankle's own angle is not recorded"},
    {"attachment_alone", 1, 0, 1, "0: no trial without a foot"},
    {"passive", 1, 0, 1, "0: no trial of a person who relaxes"},
    {"isometric", 1, 0, 1, "0: no contraction against a fixed plate"},
    {"isokinetic", 1, 0, 1, "0: active trials are rotated at their speed instead"},
    {"speeds", 6, 1, 6, "number of the six speeds of active trials that are fitted"},
    {"known_noise", 1, 0, 1, "0: the data do not state the noise level"},
    {"hidden_truth", 0, 0, 1, "1: channels true_interaction, true_sole_force, true_strap_force"},
    {"exact", 0, 0, 1, "1: torques of the fitted model, without noise"},
};

constexpr double kDegree = kPi / 180;
constexpr double kFine = 1000;  // [Hz] of the true excitations
constexpr const char* kStudied[] = {"lat_gas_r", "med_gas_r", "soleus_r", "tib_ant_r"};
constexpr std::size_t kSoleus = 2;

// What is true unless --set says otherwise: not what a fit starts from.
struct TrueValue {
  int slot;
  double value;
};
constexpr TrueValue kTrue[] = {
    {kAttachmentInertia, 0.083}, {kAttachmentGravity, 3.4}, {kAttachmentGravityAngle, 0.12},
    {kAttachmentFriction, 0.21}, {kSoleStiffness, 8.5e6},   {kStrapStiffness, 6600},
    {kStrapExponent, 105},       {kStrapPretension, 29},    {kSoleFriction, 0.15},
    {kPassiveStiffness, 11.5},   {kPassiveExponent, 5.2},   {kPassiveLinear, 3.8},
    {kPassiveDamping, 0.42},     {kAnkleShape, -1.1},       {kAnkleFilterTime, 0.026},
    {kAnkleDelay, 0.042},
};
constexpr double kTrueStrength[] = {1.22, 0.84};  // triceps, dorsiflexors
constexpr double kTrueSlack[] = {1.008, 0.991};

// Errors that no effect of the problem describes, as tests of the diagnosis. Each has one number of its name.
constexpr Outsider kAnkleOutsiders[] = {
    {"torque_ripple", "N*m", "torque of the motor that is a sine of its angle, 40 per rad"},
    {"turning_column", "rad/(N*m)",
     "angle by which the machine turns under its torque, unseen by its encoder"},
    {"tremor", "1", "activation of the soleus that is a sine of time, 5 Hz, and no electrode saw"},
    {"soleus_fades", "1/s", "the EMG of one muscle alone loses this share per second"},
    {"loose_electrode", "1", "the EMG of one muscle alone loses this share half-way"},
    {"bent_arms", "m/rad2", "moment arms that grow with the square of the angle"},
};

using Numbers = std::map<std::string, double>;

std::string SettingsText() {
  std::string text =
      "# How the ankle_on_dynamometer problem sees this person and machine.\nankle_on_dynamometer:\n"
      "  foot: {ankle_height: 0.08, heel: 0.05, toe: 0.17, width: 0.08, mass: 1.1, mass_x: 0.05, mass_y: "
      "-0.04, "
      "inertia: 0.008}\n  straps:\n    - {foot: [0.11, -0.03], plate: 0.11}\n    - {foot: [0.02, 0], plate: "
      "0.035}\n  muscles:\n";
  for (const StudyMuscle& muscle : StudyMuscles()) {
    if (std::find(std::begin(kStudied), std::end(kStudied), std::string(muscle.name)) == std::end(kStudied))
      continue;
    text += fmt::format(
        "    {}: {{isometric_force: {}, optimal_length: {}, tendon_slack_length: {}, pennation: {}, "
        "length: {:.6f}, arm: [{}, {}, {}], group: {}}}\n",
        muscle.name, muscle.isometric_force, muscle.optimal_length, muscle.slack_length, muscle.pennation,
        UnitLength(muscle, 0), muscle.arm[0], muscle.arm[1], muscle.arm[2],
        muscle.arm[0] > 0 ? "dorsiflexors" : "triceps");
  }
  return text;
}

struct TrialPlan {
  std::string name;
  Role role = Role::kTrain;
  AnkleTask task = AnkleTask::kActive;
  MachineProgram program;
};

std::vector<TrialPlan> PlanTrials(const Numbers& set) {
  std::vector<TrialPlan> plans;
  const auto rotation = [](double degrees) {
    MachineProgram program;
    program.speed = degrees * kDegree;
    program.highest = 15 * kDegree;
    program.lowest = -30 * kDegree;
    return program;
  };
  if (set.at("attachment_alone") != 0) {
    plans.push_back({"attachment_20", Role::kTrain, AnkleTask::kAttachmentAlone, rotation(20)});
    plans.push_back({"attachment_120", Role::kTrain, AnkleTask::kAttachmentAlone, rotation(120)});
  }
  if (set.at("passive") != 0) {
    plans.push_back({"passive_10", Role::kTrain, AnkleTask::kPassive, rotation(10)});
    plans.push_back({"passive_60", Role::kTrain, AnkleTask::kPassive, rotation(60)});
    plans.push_back({"passive_30", Role::kValidate, AnkleTask::kPassive, rotation(30)});
  }
  if (set.at("isometric") != 0) {
    TrialPlan hold{"isometric_0", Role::kTrain, AnkleTask::kActive, rotation(45)};
    hold.program.mode = MachineMode::kIsometric;
    plans.push_back(hold);
  }
  const auto active = [&](double degrees, Role role) {
    TrialPlan plan{fmt::format("active_{:03.0f}", degrees), role, AnkleTask::kActive, rotation(degrees)};
    if (set.at("isokinetic") != 0) plan.program.mode = MachineMode::kIsokinetic;
    plans.push_back(plan);
  };
  constexpr double kSpeeds[] = {60, 120, 30, 90, 45, 75};
  for (int i = 0; i < static_cast<int>(set.at("speeds")); ++i) active(kSpeeds[i], Role::kTrain);
  active(50, Role::kValidate);
  active(105, Role::kValidate);
  return plans;
}

// True excitations of a trial on the fine grid, and the activations that follow from them.
struct Drive {
  std::vector<std::vector<double>> excitations;  // [muscles][fine samples], from `first` on
  std::vector<std::vector<double>> activations;
  double first = 0;
};

constexpr double kBefore = 0.5;  // [s] of excitations before the trial and after it

Drive DrawDrive(const TrialPlan& plan, const std::vector<double>& values, double tremor, double duration,
                Random& random) {
  Drive drive;
  drive.first = -kBefore;
  const auto count = static_cast<std::size_t>((duration + 2 * kBefore) * kFine) + 2;
  const std::size_t muscles = std::size(kStudied);
  drive.excitations.assign(muscles, std::vector<double>(count, 0.0));
  if (plan.task == AnkleTask::kActive) {
    const auto all = DrawExcitations(StudyMotion{plan.program.speed}, drive.first, count, kFine, random);
    for (std::size_t m = 0; m < StudyMuscles().size(); ++m) {
      for (std::size_t k = 0; k < muscles; ++k) {
        if (std::string(StudyMuscles()[m].name) == kStudied[k]) drive.excitations[k] = all[m];
      }
    }
  }
  const auto at = [&](int slot) { return values[static_cast<std::size_t>(slot)]; };
  drive.activations.assign(muscles + 1, std::vector<double>(count, 0.0));
  if (plan.task != AnkleTask::kActive) return drive;
  for (std::size_t m = 0; m < muscles; ++m) {
    ExcitationFilter<double> filter(FilterOfTimes(at(kAnkleFilterTime), 0.0, 1 / kFine));
    for (std::size_t i = 0; i < count; ++i) {
      double others = 0;
      for (std::size_t k = 0; k < muscles; ++k) others += k == m ? 0 : drive.excitations[k][i];
      others /= static_cast<double>(muscles - 1);
      // Cross-talk is in the recording (see Record); what nobody recorded is here.
      const double e = std::max(0.0, drive.excitations[m][i] + at(kUnseenDrive));
      if (i == 0) filter.Settle(e);
      const double u = filter.Next(e);
      const double t = drive.first + static_cast<double>(i) / kFine;
      double a = ExponentialShape(u, at(kAnkleShape)).activation * (1 - at(kFatigue) * std::max(t, 0.0));
      if (m == kSoleus) a += tremor * std::sin(10 * kPi * t);
      drive.activations[m][i] = std::max(a, 0.0);
      drive.activations[muscles][i] += drive.activations[m][i] / static_cast<double>(muscles);
    }
  }
  return drive;
}

class Experiment {
 public:
  Experiment(Numbers set, AnkleSettings settings, std::vector<double> values, Numbers outsiders)
      : set_(std::move(set)),
        settings_(std::move(settings)),
        values_(std::move(values)),
        outsiders_(std::move(outsiders)),
        truth_(FootOf(settings_, values_)),
        curves_(MuscleCurves::Default()) {
    for (const AnkleMuscle& muscle : settings_.muscles) {
      paths_.push_back(muscle.path);
      std::vector<double>& arm = paths_.back().arm;
      arm.at(2) += std::copysign(Outside("bent_arms"), arm[0]);
    }
  }

  Result<Trial> Record(const TrialPlan& plan, std::uint64_t seed) const {
    Random random(seed);
    const double duration = set_.at("duration");
    const Drive drive = DrawDrive(plan, values_, Outside("tremor"), duration, random);
    LaboratoryTrial wanted;
    wanted.program = plan.program;
    wanted.foot = plan.task != AnkleTask::kAttachmentAlone;
    wanted.duration = duration;
    // As in the fitted model: the filter is ahead of its poles by a sample.
    const double late = values_[kAnkleDelay] + FilterLead(values_[kAnkleFilterTime], 1 / kFine);
    wanted.activation = [&](double since, std::vector<double>& activations) {
      const double place = (since - late - drive.first) * kFine;
      const auto k = static_cast<std::size_t>(std::max(0.0, place));
      const double share = place - static_cast<double>(k);
      for (std::size_t m = 0; m < activations.size(); ++m) {
        const auto& a = drive.activations[m];
        activations[m] = a[k] + share * (a[k + 1] - a[k]);
      }
    };
    Trial trial;
    trial.role = plan.role;
    trial.task = plan.task == AnkleTask::kAttachmentAlone       ? "attachment alone"
                 : plan.task == AnkleTask::kPassive             ? "passive rotation"
                 : plan.program.mode == MachineMode::kIsometric ? "isometric contraction"
                                                                : "isokinetic contraction";
    trial.conditions["foot"] = wanted.foot ? 1 : 0;
    trial.conditions["passive"] = plan.task == AnkleTask::kPassive ? 1 : 0;
    trial.conditions["speed_rad_per_s"] =
        plan.program.mode == MachineMode::kIsometric ? 0 : plan.program.speed;
    Grid grid;
    std::map<std::string, std::vector<double>> series;
    const bool exact = set_.at("exact") != 0;
    const auto noise = [&](const char* name) { return exact ? 0 : set_.at(name); };
    const double apart = 1e-4 * std::round(1e4 / set_.at("rate"));
    SINEW_TRY(SimulateLaboratory(
        settings_.foot, curves_, paths_, truth_, wanted, apart, [&](const LaboratoryInstant& now) {
          grid.time.push_back(now.time);
          // The whole machine turns under its torque, and the person's shank does not.
          const double turned = Outside("turning_column") * now.motor_torque;
          const double ripple = Outside("torque_ripple") * std::sin(40 * now.plate_angle);
          series["machine_angle"].push_back(now.plate_angle + turned +
                                            noise("angle_noise") * random.Normal());
          series["machine_torque"].push_back(ripple - now.motor_torque +
                                             noise("torque_noise") * random.Normal());
          series["ankle_angle"].push_back(now.ankle_angle + noise("ankle_noise") * random.Normal());
          series["true_interaction"].push_back(now.interaction);
          series["true_sole_force"].push_back(now.sole_normal);
          series["true_strap_force"].push_back(now.strap);
        }));
    const auto add = [&](const char* name, const char* unit, ChannelKind kind, const char* level) {
      Channel channel;
      channel.unit = unit;
      channel.kind = kind;
      channel.values = series.at(name);
      if (level != nullptr && noise(level) > 0 && set_.at("known_noise") != 0) channel.sigma = noise(level);
      grid.channels[name] = std::move(channel);
    };
    add("machine_angle", "rad", ChannelKind::kInput, nullptr);
    add("machine_torque", "N*m", ChannelKind::kMeasured, "torque_noise");
    if (wanted.foot && set_.at("ankle_angle") != 0)
      add("ankle_angle", "rad", ChannelKind::kMeasured, "ankle_noise");
    if (wanted.foot && set_.at("hidden_truth") != 0) {
      add("true_interaction", "N*m", ChannelKind::kInput, nullptr);
      add("true_sole_force", "N", ChannelKind::kInput, nullptr);
      add("true_strap_force", "N", ChannelKind::kInput, nullptr);
    }
    trial.grids["machine"] = std::move(grid);
    if (plan.task == AnkleTask::kActive) trial.grids["excitations"] = RecordEmg(drive, apart, random);
    return trial;
  }

 private:
  [[nodiscard]] double Outside(const char* name) const {
    const auto found = outsiders_.find(name);
    return found == outsiders_.end() ? 0 : found->second;
  }

  // What the electrodes see.
  [[nodiscard]] Grid RecordEmg(const Drive& drive, double apart, Random& random) const {
    Grid grid;
    const std::size_t muscles = std::size(kStudied);
    const auto every = static_cast<std::size_t>(std::lround(apart * kFine));
    const double talk = values_[kEmgCrossTalk];
    for (std::size_t m = 0; m < muscles; ++m) {
      Channel channel;
      channel.unit = "1";
      channel.kind = ChannelKind::kInput;
      for (std::size_t i = 0; i < drive.excitations[m].size(); i += std::max<std::size_t>(every, 1)) {
        double others = 0;
        for (std::size_t k = 0; k < muscles; ++k) others += k == m ? 0 : drive.excitations[k][i];
        const double since = drive.first + static_cast<double>(i) / kFine;
        double kept = 1;
        if (m == kSoleus) {
          const bool loose = since > 0.5 * set_.at("duration");
          kept =
              (1 - Outside("soleus_fades") * std::max(since, 0.0)) * (1 - Outside("loose_electrode") * loose);
        }
        const double seen = kept * drive.excitations[m][i] +
                            talk * others / static_cast<double>(muscles - 1) +
                            set_.at("emg_noise") * random.Normal();
        channel.values.push_back(std::clamp(seen, 0.0, 1.0));
        if (m == 0) grid.time.push_back(since);
      }
      grid.channels[kStudied[m]] = std::move(channel);
    }
    return grid;
  }

  Numbers set_;
  AnkleSettings settings_;
  std::vector<double> values_;
  Numbers outsiders_;
  StrappedFoot<double> truth_;
  MuscleCurves curves_;
  std::vector<MusclePath> paths_;
};

// Torques and angles of the fitted model in place of the laboratory's.
Status MakeExact(const AnkleSettings& settings, const std::vector<double>& values, Dataset& data) {
  SINEW_ASSIGN(const AnkleData prepared, PrepareAnkleData(data, settings, 0));
  FootSolutions solutions;
  for (const AnkleTrial& trial : prepared.trials) {
    Grid& grid = data.trials.at(trial.name).grids.at("machine");
    const bool angle = grid.channels.count("ankle_angle") > 0;
    SINEW_TRY(RunAnkleTrial(prepared, trial, values, solutions,
                            [&](std::size_t s, double torque, const StrappedFootRun<double>* run) {
                              grid.channels.at("machine_torque").values[s] = torque;
                              if (angle && run != nullptr)
                                grid.channels.at("ankle_angle").values[s] = run->instant().ankle_angle;
                            }));
  }
  return {};
}

struct Truth {
  Numbers set;
  std::vector<double> values;
  Numbers outsiders;
};

Result<Truth> ReadTruth(const SynthesisRequest& request, const AnkleSettings& settings,
                        const ParameterList& list) {
  Truth truth;
  truth.values = AnkleDefaults(settings);
  for (const TrueValue& entry : kTrue) truth.values[static_cast<std::size_t>(entry.slot)] = entry.value;
  for (std::size_t m = 0; m < settings.muscles.size(); ++m) {
    const std::size_t group = settings.muscles[m].group == "triceps" ? 0 : 1;
    truth.values[static_cast<std::size_t>(SlotOfMuscle(m, kAnkleStrength))] = kTrueStrength[group];
    truth.values[static_cast<std::size_t>(SlotOfMuscle(m, kAnkleSlackLength))] = kTrueSlack[group];
  }
  const auto store = [&](const std::string& name, double value) -> Status {
    SINEW_ASSIGN(const int index, FindParameter(list.parameters, name));
    for (std::size_t slot = 0; slot < list.index.size(); ++slot) {
      if (list.index[slot] == index) truth.values[slot] = value;
    }
    return {};
  };
  SynthesisRequest settings_alone = request;
  for (const auto& [name, value] : request.set) {
    const auto found = std::find_if(
        list.parameters.begin(), list.parameters.end(),
        [&, &n = name](const Parameter& p) { return p.name == n && p.kind == ParameterKind::kBase; });
    if (found == list.parameters.end()) continue;
    if (!(value >= found->lower && value <= found->upper))
      return Fail("--set {}={}: expected {} to {}", name, value, found->lower, found->upper);
    SINEW_TRY(store(name, value));
    settings_alone.set.erase(name);
  }
  SINEW_ASSIGN(
      truth.set,
      ReadExperiment(kSettings, {"torque_noise", "angle_noise", "ankle_noise", "emg_noise"}, settings_alone));
  const ParameterList outside = ListOutsiders(kAnkleOutsiders);
  SINEW_ASSIGN(const auto hidden, ReadHiddenEffects(request.effects, list, outside));
  for (const auto& [name, value] : hidden) {
    if (!FindParameter(outside.parameters, name)) {
      SINEW_TRY(store(name, value));
    } else if (truth.set.at("exact") != 0) {
      return Fail("--effect {}: with exact=1 torques are those of the fitted model, which does not have it",
                  name);
    } else {
      truth.outsiders[name] = value;
    }
  }
  return truth;
}

}  // namespace

Result<Dataset> SynthesizeAnkle(const SynthesisRequest& request) {
  const std::string text = SettingsText();
  SINEW_ASSIGN(const YamlReader yaml, YamlReader::Parse(text, "ankle_on_dynamometer.yaml"));
  SINEW_ASSIGN(const YamlReader section, yaml.At("ankle_on_dynamometer"));
  SINEW_ASSIGN(const AnkleSettings settings, ReadAnkleSettings(section));
  SINEW_ASSIGN(const ParameterList list, ListAnkleParameters(settings));
  SINEW_ASSIGN(const Truth truth, ReadTruth(request, settings, list));
  Dataset data;
  data.title = "an ankle on a dynamometer, made up";
  data.source = "sinew data synthesize ankle_on_dynamometer";
  data.licence = "CC0-1.0";
  data.synthetic = true;
  data.files["ankle_on_dynamometer.yaml"] = text;
  const Experiment experiment(truth.set, settings, truth.values, truth.outsiders);
  const auto plans = PlanTrials(truth.set);
  std::vector<Result<Trial>> trials(plans.size(), Trial());
  CurrentExecutor().ForEach(plans.size(), [&](std::size_t i, std::size_t) {
    trials[i] = experiment.Record(plans[i], Random::StreamSeed(request.seed, i));
  });
  for (std::size_t i = 0; i < plans.size(); ++i) {
    if (!trials[i]) return Fail("{}: {}", plans[i].name, trials[i].error().message);
    data.trials[plans[i].name] = std::move(*trials[i]);
  }
  if (truth.set.at("exact") != 0) SINEW_TRY(MakeExact(settings, truth.values, data));
  SINEW_TRY(data.Check());
  return data;
}

std::vector<std::pair<std::string, std::string>> AnkleExperiment() {
  return DescribeSettings(kSettings);
}

}  // namespace sinew
