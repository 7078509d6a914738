#include "problems/ankle_study/recording.h"

#include <algorithm>
#include <cmath>

#include "base/constants.h"
#include "models/emg/envelope.h"
#include "problems/nms/ceinms/subject.h"
#include "problems/nms/settings.h"

namespace sinew {
namespace {

using Values = std::map<std::string, double>;

constexpr double kMargin = 0.5;                   // [s] of EMG before and after the moments
constexpr double kExcitationRate = 200;           // [Hz]
constexpr std::size_t kFine = 10;                 // fine frames per recorded one
constexpr double kMiddle = -7.5 * kPi / 180;      // [rad] of the range of the angle
constexpr double kSlow = 0.03 * 120 * kPi / 180;  // [rad/s] below which the direction counts in part

double At(const std::vector<double>& values, double first, double rate, double time) {
  const double place = std::clamp((time - first) * rate, 0.0, static_cast<double>(values.size() - 1));
  const auto k = std::min(static_cast<std::size_t>(place), values.size() - 2);
  const double share = place - static_cast<double>(k);
  return values[k] + share * (values[k + 1] - values[k]);
}

class Recording {
 public:
  Recording(const StudyTruth& truth, const StudyTrial& trial, std::uint64_t seed)
      : truth_(truth), name_(trial.name), random_(seed) {
    motion_.speed = trial.degrees_per_second * kPi / 180;
    const double duration = truth.settings.at("cycles") * motion_.cycle();
    frames_ = static_cast<std::size_t>(duration * kStudyRate) + 1;
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
  // The excitation under the electrodes: an effect can make it differ from that of the muscles.
  [[nodiscard]] std::vector<std::vector<double>> SeenExcitations() const {
    const double drift = truth_.Effect("emg_drift");
    const double gain = truth_.Effect("emg_gain@" + name_);
    const double cross = truth_.Effect("cross_talk");
    const double floor = truth_.Effect("co_contraction") + truth_.Effect("emg_offset@" + name_);
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
    grid.time = StudyTimes(-kMargin, kExcitationRate, count);
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
          if (emg.time.empty()) emg.time = StudyTimes(-kMargin, kStudyEmgRate, samples_);
          emg.channels[StudyMuscles()[m].name] = StudyInput("V", std::move(raw));
        }
      }
      std::vector<double> values;
      for (const double t : grid.time)
        values.push_back(std::clamp(At(recorded, -kMargin, kStudyEmgRate, t), 0.0, 1.0));
      grid.channels[StudyMuscles()[m].name] = StudyInput("1", std::move(values));
    }
    return {};
  }

  void RecordMotion() {
    const auto times = StudyTimes(0, kStudyRate, frames_);
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
      lengths.channels[muscle.name] = StudyInput("m", std::move(length));
      arms.channels[muscle.name] = StudyInput("m", std::move(arm));
    }
    Grid& motion = out_.grids["motion"];
    motion.time = times;
    motion.channels[kStudyJoint] = StudyInput("rad", std::move(angle));
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
    auto slots = SlotsOf(subject, false, kStudyRate);
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
    const auto times = StudyTimes(0, exact ? kStudyRate : kStudyFineRate, frames);
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
        signals.excitation_time = StudyTimes(-kMargin, kStudyEmgRate, samples_);
        signals.excitation = pulling_[m];
      }
      signals.time = times;
      for (const auto& at : motion) signals.unit_length.push_back(UnitLength(muscle, at.angle));
      MuscleTrace<double> trace;
      const Status status = ComputeMuscleForce(curves, MuscleModel{}, TrueSlots(muscle), signals, trace);
      if (!status) return Fail("{}, {}: {}", name_, muscle.name, status.error().message);
      for (std::size_t i = 0; i < frames; ++i) {
        const double arm = MomentArm(muscle, motion[i].angle);
        const double bent = truth_.Effect("bent_arms") * std::pow(motion[i].angle - kMiddle, 2);
        const double way = truth_.Effect("directional_force") * std::tanh(motion[i].velocity / kSlow);
        moment[i] += (arm + truth_.OfJoint("arm_offset") + bent) * (1 + way) * trace.tendon_force[i];
        (arm > 0 ? pull_plus : pull_minus)[i] += trace.activation[i] / (muscle.arm[0] > 0 ? 2 : 5);
      }
    }
    AddMoments(times, motion, pull_plus, pull_minus, moment);
    Grid& grid = out_.grids["moments"];
    grid.time = StudyTimes(0, kStudyRate, frames_);
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
    for (std::size_t i = 0; i < moment.size(); ++i) {
      const auto& at = motion[i];
      moment[i] += -truth_.OfJoint("passive_stiffness") * (at.angle - kMiddle) -
                   truth_.OfJoint("joint_damping") * at.velocity +
                   truth_.OfJoint("inertial_moment") * at.acceleration +
                   truth_.OfJoint("weight_sine") * std::sin(at.angle) +
                   truth_.OfJoint("weight_cosine") * std::cos(at.angle) -
                   truth_.OfJoint("machine_friction") * std::tanh(at.velocity / kSlow) +
                   truth_.OfJoint("missing_muscle_plus") * pull_plus[i] -
                   truth_.OfJoint("missing_muscle_minus") * pull_minus[i];
      moment[i] += truth_.Effect("ripple") * std::sin(40 * at.angle) +
                   truth_.Effect("tension_curve") * std::pow(at.angle - kMiddle, 3) +
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

}  // namespace

Result<Trial> RecordStudyTrial(const StudyTruth& truth, const StudyTrial& trial, std::uint64_t seed) {
  return Recording(truth, trial, seed).Make();
}

}  // namespace sinew
