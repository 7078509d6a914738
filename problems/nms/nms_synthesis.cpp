#include "problems/nms/nms_synthesis.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/constants.h"
#include "models/emg/envelope.h"
#include "problems/experiment_settings.h"
#include "problems/nms/ankle_study.h"
#include "problems/nms/ceinms_subject.h"
#include "problems/nms/nms_problem.h"

namespace sinew {
namespace {

constexpr ExperimentSetting kSettings[] = {
    {"triceps.strength", 0.8, 0.5, 1.5, "true factor on the force of gastrocnemii and soleus"},
    {"peronei.strength", 1.2, 0.5, 1.5, "true factor on the force of peroneus longus and brevis"},
    {"dorsiflexors.strength", 1.1, 0.5, 1.5,
     "true factor on the force of tibialis anterior and peroneus tertius"},
    {"plantarflexors.shape", -1.2, -3, 0, "true bend of gastrocnemii, soleus and peronei"},
    {"dorsiflexors.shape", -0.8, -3, 0, "true bend of tibialis anterior and peroneus tertius"},
    {"triceps.tendon_slack_length", 1.01, 0.95, 1.05, "true factor on the subject's"},
    {"dorsiflexors.tendon_slack_length", 0.98, 0.95, 1.05, "true factor on the subject's"},
    {"train", 4, 1, 4, "training trials: those at 120, 90, 60 and 30 deg/s, in this order"},
    {"validate", 2, 0, 2, "validation trials: those at 75 and 45 deg/s, in this order"},
    {"cycles", 4, 1, 100, "up and down again, per trial"},
    {"moment_noise", 1, 0, 100, "standard deviation of the moment's noise [N m]"},
    {"electrodes", 1024, 0, 100000,
     "per muscle, whose envelopes are averaged; 0: excitations are the true ones"},
    {"raw", 0, 0, 1, "1: the raw EMG of one electrode per muscle is in the data too"},
    {"known_noise", 0, 0, 1, "1: the data say how large the moment's noise is"},
    {"exact", 0, 0, 1, "1: no noise, and moments of the fitted model itself"},
};

struct StudyTrial {
  const char* name;
  double degrees_per_second;
  Role role;
};
constexpr StudyTrial kTrials[] = {
    {"train_120", 120, Role::kTrain},     {"train_90", 90, Role::kTrain},
    {"train_60", 60, Role::kTrain},       {"train_30", 30, Role::kTrain},
    {"validate_75", 75, Role::kValidate}, {"validate_45", 45, Role::kValidate},
};

constexpr const char* kSettingsText = R"(# How the nms problem sees the ankle study.
nms:
  subject: subject.xml
  tendon: rigid
  joints: [ankle_angle_r]
  parameters:
    strength:
      groups:
        triceps: [lat_gas_r, med_gas_r, soleus_r]
        peronei: [per_long_r, per_brev_r]
        dorsiflexors: [tib_ant_r, per_tert_r]
      lower: 0.5
      upper: 1.5
    shape:
      groups:
        plantarflexors: [lat_gas_r, med_gas_r, soleus_r, per_long_r, per_brev_r]
        dorsiflexors: [tib_ant_r, per_tert_r]
      lower: -3
      upper: 0
    tendon_slack_length:
      groups:
        triceps: [lat_gas_r, med_gas_r, soleus_r]
        dorsiflexors: [tib_ant_r, per_tert_r]
      lower: 0.95
      upper: 1.05
      relative: true
)";

constexpr double kMargin = 0.5;          // [s] of EMG before and after the moments
constexpr double kFineRate = 1000;       // [Hz] of the truth
constexpr double kRate = 100;            // [Hz] of the recorded moments
constexpr double kExcitationRate = 200;  // [Hz]
constexpr std::size_t kFine = 10;        // fine frames per recorded one

// What no effect of the problem is, to see what the diagnosis makes of it. Each has one number of its name.
constexpr const char* kOutsiders[] = {
    "ripple",           // moment that is a sine of the angle [N m]
    "tension_curve",    // moment that grows with the third power of the angle [N m/rad3]
    "tremor",           // moment that is a sine of time, 5 Hz [N m]
    "soleus_fades",     // the EMG of one muscle alone loses this share per second [1/s]
    "loose_electrode",  // the EMG of one muscle alone loses this share half-way [1]
};

// Effects of the problem that the study can contain; those of a trial alone are left out, but for emg_gain.
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
  return name.rfind("emg_gain@", 0) == 0 ||
         std::find(std::begin(kSimulated), std::end(kSimulated), name) != std::end(kSimulated);
}

bool IsOutsider(const std::string& name) {
  return std::find(std::begin(kOutsiders), std::end(kOutsiders), name) != std::end(kOutsiders);
}

using Values = std::map<std::string, double>;

struct StudyTruth {
  Values settings;
  Values effects;  // by parameter

  [[nodiscard]] double Effect(const std::string& parameter) const {
    const auto found = effects.find(parameter);
    return found == effects.end() ? 0 : found->second;
  }
  [[nodiscard]] double OfJoint(const std::string& parameter) const {
    return Effect(parameter + "." + kStudyJoint);
  }
};

std::vector<double> Times(double first, double rate, std::size_t count) {
  std::vector<double> times;
  for (std::size_t i = 0; i < count; ++i) times.push_back(first + static_cast<double>(i) / rate);
  return times;
}

double At(const std::vector<double>& values, double first, double rate, double time) {
  const double place = std::clamp((time - first) * rate, 0.0, static_cast<double>(values.size() - 1));
  const auto k = std::min(static_cast<std::size_t>(place), values.size() - 2);
  const double share = place - static_cast<double>(k);
  return values[k] + share * (values[k + 1] - values[k]);
}

Channel Input(const char* unit, std::vector<double> values) {
  return {unit, ChannelKind::kInput, {}, std::move(values)};
}

class Recording {
 public:
  Recording(const StudyTruth& truth, const StudyTrial& trial, std::uint64_t seed)
      : truth_(truth), name_(trial.name), random_(seed) {
    motion_.speed = trial.degrees_per_second * kPi / 180;
    const double duration = truth.settings.at("cycles") * motion_.cycle();
    frames_ = static_cast<std::size_t>(duration * kRate) + 1;
    fine_ = (frames_ - 1) * kFine + 1;
    samples_ = static_cast<std::size_t>((duration + 2 * kMargin) * kStudyEmgRate) + 1;
    out_.role = trial.role;
    out_.task = "ankle up and down";
    out_.conditions["speed_rad_per_s"] = motion_.speed;
  }

  Result<Trial> Make() {
    pulling_ = DrawExcitations(motion_, -kMargin, samples_, kStudyEmgRate, random_);
    SINEW_TRY(RecordEmg());
    RecordMotion();
    SINEW_TRY(RecordMoment());
    return std::move(out_);
  }

 private:
  // What the electrodes are above: other than what pulls, if an effect says so.
  [[nodiscard]] std::vector<std::vector<double>> SeenExcitations() const {
    const double drift = truth_.Effect("emg_drift");
    const double gain = truth_.Effect("emg_gain@" + name_);
    const double cross = truth_.Effect("cross_talk");
    const double floor = truth_.Effect("co_contraction");
    const double fades = truth_.Effect("soleus_fades");
    const double loose = truth_.Effect("loose_electrode");
    auto seen = pulling_;
    for (std::size_t m = 0; m < seen.size(); ++m) {
      for (std::size_t k = 0; k < samples_; ++k) {
        double others = 0;
        for (std::size_t other = 0; other < pulling_.size(); ++other)
          others += other == m ? 0 : pulling_[other][k] / static_cast<double>(kStudyMuscles - 1);
        const double e = std::max(0.0, pulling_[m][k] - floor) + cross * others;
        const double since = static_cast<double>(k) / kStudyEmgRate;
        seen[m][k] = e / (1 + gain + drift * since);
        const std::string name = StudyMuscles()[m].name;
        if (name == "soleus_r") seen[m][k] *= std::max(0.0, 1 - fades * since);
        if (name == "med_gas_r" && 2 * k > samples_) seen[m][k] *= 1 - loose;
      }
    }
    return seen;
  }

  Status RecordEmg() {
    const auto seen = SeenExcitations();
    const double electrodes = truth_.settings.at("exact") != 0 ? 0 : truth_.settings.at("electrodes");
    const double share = electrodes > 0 ? 1 / std::sqrt(electrodes) : 0;
    Grid& grid = out_.grids["excitations"];
    const auto count =
        static_cast<std::size_t>(static_cast<double>(samples_ - 1) / kStudyEmgRate * kExcitationRate) + 1;
    grid.time = Times(-kMargin, kExcitationRate, count);
    for (std::size_t m = 0; m < seen.size(); ++m) {
      std::vector<double> recorded = seen[m];
      if (share > 0) {
        std::vector<double> raw = DrawRawEmg(seen[m], random_);
        SINEW_ASSIGN(const Envelope envelope, ComputeEnvelope(raw, kStudyEmgRate, {}));
        // The error of a mean of many envelopes is that of one, smaller by the root of their number.
        for (std::size_t k = 0; k < samples_; ++k)
          recorded[k] += share * (envelope.values[k] / kStudyFullEmg - recorded[k]);
        if (truth_.settings.at("raw") != 0) {
          Grid& emg = out_.grids["emg"];
          if (emg.time.empty()) emg.time = Times(-kMargin, kStudyEmgRate, samples_);
          emg.channels[StudyMuscles()[m].name] = Input("V", std::move(raw));
        }
      }
      std::vector<double> values;
      for (const double t : grid.time)
        values.push_back(std::clamp(At(recorded, -kMargin, kStudyEmgRate, t), 0.0, 1.0));
      grid.channels[StudyMuscles()[m].name] = Input("1", std::move(values));
    }
    return {};
  }

  void RecordMotion() {
    const auto times = Times(0, kRate, frames_);
    std::vector<double> angle;
    for (const double t : times) angle.push_back(motion_.Get(t).angle);
    Grid& lengths = out_.grids["lengths"];
    Grid& arms = out_.grids[std::string("moment_arms.") + kStudyJoint];
    lengths.time = arms.time = times;
    for (const StudyMuscle& muscle : StudyMuscles()) {
      std::vector<double> length;
      std::vector<double> arm;
      for (const double q : angle) {
        length.push_back(UnitLength(muscle, q));
        arm.push_back(MomentArm(muscle, q));
      }
      lengths.channels[muscle.name] = Input("m", std::move(length));
      arms.channels[muscle.name] = Input("m", std::move(arm));
    }
    Grid& motion = out_.grids["motion"];
    motion.time = times;
    motion.channels[kStudyJoint] = Input("rad", std::move(angle));
  }

  // Numbers of a muscle as they truly are.
  [[nodiscard]] std::array<double, kMuscleSlots> TrueSlots(const StudyMuscle& muscle) const {
    const std::string name = muscle.name;
    const bool dorsi = name == "tib_ant_r" || name == "per_tert_r";
    const bool peroneus = name == "per_long_r" || name == "per_brev_r";
    const std::string group = dorsi ? "dorsiflexors" : peroneus ? "peronei" : "triceps";
    const Values& set = truth_.settings;
    SubjectMuscle subject;
    subject.c1 = subject.c2 = -0.7;
    subject.shape_factor = set.at(dorsi ? "dorsiflexors.shape" : "plantarflexors.shape");
    subject.delay = 0.04;
    subject.optimal_fibre_length = muscle.optimal_length;
    subject.pennation_angle = muscle.pennation;
    subject.tendon_slack_length =
        muscle.slack_length * (peroneus ? 1 : set.at(group + ".tendon_slack_length"));
    subject.maximal_isometric_force = muscle.isometric_force;
    subject.strength_coefficient = set.at(group + ".strength");
    auto slots = SlotsOf(subject, false, kRate);
    slots[kDelay] += truth_.Effect("longer_delay");
    slots[kFilterMean] *= 1 + truth_.Effect("slower_activation");
    slots[kLargestVelocity] *= 1 + truth_.Effect("contraction_velocity");
    slots[kOptimalLength] *= 1 + truth_.Effect("fibre_length");
    slots[kLengthChange] += truth_.Effect("length_by_activation");
    slots[kEnhancement] = truth_.Effect("force_enhancement");
    slots[kDepression] = truth_.Effect("force_depression");
    slots[kTendonCompliance] = truth_.Effect("compliant_tendon");
    return slots;
  }

  Status RecordMoment() {
    SINEW_ASSIGN(const CeinmsSubject generic, ReadCeinmsSubject(StudySubjectXml(), "subject.xml"));
    SINEW_ASSIGN(const MuscleCurves curves, CurvesOf(generic.subject, false));
    const bool exact = truth_.settings.at("exact") != 0;
    const std::size_t step = exact ? kFine : 1;
    const std::size_t frames = exact ? frames_ : fine_;
    const auto times = Times(0, exact ? kRate : kFineRate, frames);
    std::vector<StudyMotion::At> motion;
    for (const double t : times) {
      motion.push_back(motion_.Get(t));
      motion.back().angle += truth_.OfJoint("angle_offset");
    }
    std::vector<double> moment(frames, 0);
    std::vector<double> pull_plus(frames, 0);
    std::vector<double> pull_minus(frames, 0);
    for (std::size_t m = 0; m < StudyMuscles().size(); ++m) {
      const StudyMuscle& muscle = StudyMuscles()[m];
      MuscleSignals signals;
      if (exact) {
        const Grid& grid = out_.grids.at("excitations");
        signals.excitation_time = grid.time;
        signals.excitation = grid.channels.at(muscle.name).values;
      } else {
        signals.excitation_time = Times(-kMargin, kStudyEmgRate, samples_);
        signals.excitation = pulling_[m];
      }
      signals.time = times;
      for (const auto& at : motion) signals.unit_length.push_back(UnitLength(muscle, at.angle));
      MuscleTrace<double> trace;
      const Status status = ComputeMuscleForce(curves, MuscleModel{}, TrueSlots(muscle), signals, trace);
      if (!status) return Fail("{}, {}: {}", name_, muscle.name, status.error().message);
      for (std::size_t i = 0; i < frames; ++i) {
        const double arm = MomentArm(muscle, motion[i].angle);
        moment[i] += (arm + truth_.OfJoint("arm_offset")) * trace.tendon_force[i];
        (arm > 0 ? pull_plus : pull_minus)[i] += trace.activation[i] / (muscle.arm[0] > 0 ? 2 : 5);
      }
    }
    AddMoments(times, motion, pull_plus, pull_minus, moment);
    Grid& grid = out_.grids["moments"];
    grid.time = Times(0, kRate, frames_);
    Channel channel{"N*m", ChannelKind::kMeasured, {}, {}};
    const double noise = exact ? 0 : truth_.settings.at("moment_noise");
    ApplySensor(times, moment);
    for (std::size_t i = 0; i < frames; i += kFine / step)
      channel.values.push_back(moment[i] + noise * random_.Normal());
    if (truth_.settings.at("known_noise") != 0 && noise > 0) channel.sigma = noise;
    grid.channels[std::string(kStudyJoint) + "_moment"] = std::move(channel);
    return {};
  }

  void AddMoments(const std::vector<double>& times, const std::vector<StudyMotion::At>& motion,
                  const std::vector<double>& pull_plus, const std::vector<double>& pull_minus,
                  std::vector<double>& moment) const {
    const double middle = -7.5 * kPi / 180;
    const double slow = 0.03 * 120 * kPi / 180;
    for (std::size_t i = 0; i < moment.size(); ++i) {
      const auto& at = motion[i];
      moment[i] += -truth_.OfJoint("passive_stiffness") * (at.angle - middle) -
                   truth_.OfJoint("joint_damping") * at.velocity +
                   truth_.OfJoint("inertial_moment") * at.acceleration +
                   truth_.OfJoint("weight_sine") * std::sin(at.angle) +
                   truth_.OfJoint("weight_cosine") * std::cos(at.angle) -
                   truth_.OfJoint("machine_friction") * std::tanh(at.velocity / slow) +
                   truth_.OfJoint("missing_muscle_plus") * pull_plus[i] -
                   truth_.OfJoint("missing_muscle_minus") * pull_minus[i];
      moment[i] += truth_.Effect("ripple") * std::sin(40 * at.angle) +
                   truth_.Effect("tension_curve") * std::pow(at.angle - middle, 3) +
                   truth_.Effect("tremor") * std::sin(10 * kPi * times[i]);
    }
  }

  // The moment's sensor: late, slow, then scaled.
  void ApplySensor(const std::vector<double>& times, std::vector<double>& values) const {
    const std::string channel = std::string(kStudyJoint) + "_moment.";
    const double gain = 1 + truth_.Effect(channel + "gain");
    const double late = truth_.Effect(channel + "time_offset");
    const double slow = truth_.Effect(channel + "low_pass");
    const double middle = 0.5 * (times.front() + times.back());
    const double rate = static_cast<double>(times.size() - 1) / (times.back() - times.front());
    const std::vector<double> moment = values;
    double smooth = moment.front();
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (slow > 0 && i > 0) {
        // Exact for a moment that runs straight between the fine frames.
        const double kept = std::exp(-1 / (rate * slow));
        const double rise = (moment[i] - moment[i - 1]) * rate;
        smooth = kept * (smooth - moment[i - 1] + slow * rise) + moment[i] - slow * rise;
        values[i] = smooth;
      }
    }
    const std::vector<double> smoothed = values;
    for (std::size_t i = 0; i < values.size(); ++i) {
      const double seen = late == 0 ? smoothed[i] : At(smoothed, times.front(), rate, times[i] - late);
      values[i] = gain * seen + truth_.Effect(channel + "offset") +
                  truth_.Effect(channel + "drift") * (times[i] - middle);
    }
  }

  const StudyTruth& truth_;
  std::string name_;
  Random random_;
  StudyMotion motion_;
  std::size_t frames_ = 0;
  std::size_t fine_ = 0;
  std::size_t samples_ = 0;
  std::vector<std::vector<double>> pulling_;  // true excitations at the rate of the EMG
  Trial out_;
};

Result<Dataset> Record(const StudyTruth& truth, std::uint64_t seed) {
  Dataset data;
  data.title = "an ankle on a dynamometer, made up";
  data.source = "sinew data synthesize nms";
  data.licence = "CC0-1.0";
  data.synthetic = true;
  data.files["nms.yaml"] = kSettingsText;
  data.files["subject.xml"] = StudySubjectXml();
  std::uint64_t stream = 0;
  double train = truth.settings.at("train");
  double validate = truth.settings.at("validate");
  for (const StudyTrial& trial : kTrials) {
    double& left = trial.role == Role::kTrain ? train : validate;
    if (left-- < 1) continue;
    SINEW_ASSIGN(data.trials[trial.name], Recording(truth, trial, Random::StreamSeed(seed, stream++)).Make());
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
  SINEW_ASSIGN(const ProblemEntry* entry, FindProblem("nms"));
  SINEW_ASSIGN(const YamlReader yaml, YamlReader::Parse(kSettingsText, "nms.yaml"));
  SINEW_ASSIGN(const BoundProblem bound, entry->bind(data, yaml, true));
  const auto& effects = bound.problem->effects();
  for (const auto& [name, numbers] : request.effects) {
    if (IsOutsider(name)) {
      for (const auto& [parameter, value] : numbers) {
        if (parameter != name)
          return Fail("--effect {}: '{}' does not exist; did you mean '{}'?", name, parameter, name);
        truth.effects[parameter] = value;
      }
      continue;
    }
    const auto effect = std::find_if(effects.begin(), effects.end(),
                                     [&, wanted = name](const Effect& e) { return e.name == wanted; });
    if (effect == effects.end()) {
      std::vector<std::string> names(std::begin(kOutsiders), std::end(kOutsiders));
      for (const Effect& e : effects) names.push_back(e.name);
      return Fail("--effect: '{}' does not exist{}", name, Suggestion(name, names));
    }
    if (!IsSimulated(name)) return Fail("--effect {}: the ankle study cannot contain it", name);
    for (const auto& [parameter, value] : numbers) {
      std::vector<std::string> names;
      const Parameter* found = nullptr;
      for (const int index : effect->parameters) {
        const Parameter& p = bound.problem->parameters()[static_cast<std::size_t>(index)];
        names.push_back(p.name);
        if (p.name == parameter) found = &p;
      }
      if (found == nullptr)
        return Fail("--effect {}: '{}' does not exist{}", name, parameter, Suggestion(parameter, names));
      if (!(value >= found->lower && value <= found->upper))
        return Fail("--effect {}: {} = {}, expected {} to {}", name, parameter, value, found->lower,
                    found->upper);
      // Gains rest at 1.
      truth.effects[parameter] = value - found->null_value;
    }
  }
  return {};
}

}  // namespace

Result<Dataset> SynthesizeNms(const SynthesisRequest& request) {
  StudyTruth truth;
  SINEW_ASSIGN(truth.settings, ReadExperiment(kSettings, {"moment_noise"}, request));
  if (request.noise)
    truth.settings["electrodes"] *= *request.noise > 0 ? 1 / (*request.noise * *request.noise) : 0;
  SINEW_TRY(ReadEffects(request, truth));
  return Record(truth, request.seed);
}

std::vector<std::pair<std::string, std::string>> NmsExperiment() {
  return DescribeSettings(kSettings);
}

std::vector<Parameter> DefaultNmsParameters() {
  SynthesisRequest request;
  request.set = {{"exact", 1}, {"cycles", 1}};
  const auto data = SynthesizeNms(request);
  if (!data) return {};
  const auto yaml = YamlReader::Parse(kSettingsText, "nms.yaml");
  auto settings = ReadNmsSettings(yaml->At("nms").value(), data->files);
  if (!settings) return {};
  const auto problem = NmsProblem::Make(*data, std::move(*settings));
  return problem ? (*problem)->parameters() : std::vector<Parameter>();
}

}  // namespace sinew
